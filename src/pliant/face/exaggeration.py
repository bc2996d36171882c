"""Caricature: what sets a face apart from the mean, exaggerated (Brennan 1985, "Caricature generator").

Landmarks go to p + k (p - mean), with a gain for each feature; the face in between follows by a free-form deformation,
with the landmarks of the features as sites (Dirichlet FFD) or with a lattice of B-splines that brings them there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidParameter
from pliant.face.face import Face
from pliant.face.features import GROUPS, group_of_sites, sites
from pliant.face.folding import without_folds
from pliant.face.identity import difference_from_mean
from pliant.mesh import Points
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.direct import pull
from pliant.space.dirichlet_ffd import DirichletFFD

Floats = NDArray[np.float64]
Way = Literal["sites", "lattice"]

SHAPE = 8, 9, 7  # control points of the lattice
ROOM = 0.15  # around the face, as a part of its size
STIFFNESS = 0.02  # how little the lattice moves rather than meet each landmark
MOST = 5.0  # of an amount or a gain


@dataclass(frozen=True, eq=False)
class Caricature:
    """A caricature, and how it came about.

    Parameters
    ----------
    face
        The face after the deformation; it wears the same picture.
    deformer
        The deformation, a map of space: of other meshes of the face too.
    amount
        How much was done: less than asked for where more would fold.
    asked
        How much was asked for.
    least
        The least det J that was found where the face is: above zero, nothing folds there.
    proved
        Whether it is proved that nothing folds, in all of space.
    """

    face: Face
    deformer: SpaceDeformer
    amount: float
    asked: float
    least: float
    proved: bool

    def __str__(self) -> str:
        how = "proved everywhere" if self.proved else "looked at on the face"
        limited = "" if self.amount == self.asked else f" (of {self.asked:.3g}: more would fold)"
        return f"caricature by {self.amount:.3g}{limited}, det J >= {self.least:.3g}, {how}"


def caricature(
    face: Face,
    amount: float = 0.8,
    groups: Mapping[str, float] | None = None,
    *,
    expression: float = 0.0,
    by: Way = "sites",
) -> Caricature:
    """A face with what is its own exaggerated.

    Parameters
    ----------
    face
        A face from a photograph, of any density.
    amount
        How far from the mean: 0 leaves the face, 1 doubles its difference, -1 gives the mean face with the
        expression of the face.
    groups
        Gains by feature: ``brows``, ``eyes``, ``nose``, ``mouth``, ``chin``, ``cheeks``, ``outline``; 1 where none is
        given.
    expression
        How much of the expression is exaggerated along: 0 = a smile stays as it is, 1 = like all else.
    by
        ``"sites"``: Dirichlet free-form deformation with landmarks as sites. ``"lattice"``: a B-spline lattice, pulled
        so that landmarks reach their places nearly.

    Raises
    ------
    InvalidParameter
        A name that is no group, an amount or a gain that is not finite or beyond 5.
    """
    gains = _gains(groups or {})
    for name, value in (("amount", amount), ("expression", expression)):
        _require_moderate(name, value)
    if by not in get_args(Way):
        raise InvalidParameter(f"a caricature is made by 'sites' or by 'lattice'; given: {by!r}")
    parts = difference_from_mean(face.landmarks)
    chosen = sites()[0]
    influence = DirichletFFD(face.landmarks[chosen]).bind(face.landmarks).matrix() @ group_of_sites()
    wanted = amount * (influence @ gains)[:, None] * (parts.identity + expression * parts.expression)
    result = without_folds(_moving(face, chosen, wanted, by), face.mesh)
    mesh = result.deformer(face.mesh)
    landmarks = result.deformer(face.landmarks)
    moved = Face(mesh, landmarks, face.picture, face.pose, face.score)
    return Caricature(moved, result.deformer, amount * result.part, amount, result.least, result.proved)


def _moving(face: Face, chosen: NDArray[np.int64], wanted: Points, by: Way) -> DirichletFFD | BSplineFFD:
    """A deformer that brings the landmarks where they are wanted."""
    if by == "sites":
        deformer = DirichletFFD(face.landmarks[chosen], smooth=True)
        return deformer.moved(deformer.rest + wanted[chosen])
    lattice = BSplineFFD.around(face.mesh, shape=SHAPE, margin=ROOM)
    return pull(lattice, face.landmarks, face.landmarks + wanted, regularization=STIFFNESS)


def _gains(groups: Mapping[str, float]) -> Floats:
    """(g,) the gain of each group."""
    for name, gain in groups.items():
        if name not in GROUPS:
            raise InvalidParameter(f"no feature is called {name!r}; there are: {', '.join(GROUPS)}")
        _require_moderate(f"the gain of {name!r}", gain)
    return np.array([groups.get(name, 1.0) for name in GROUPS])


def _require_moderate(name: str, value: float) -> None:
    if not abs(value) <= MOST:
        raise InvalidParameter(f"{name} is {value:g}; it must lie between -{MOST:g} and {MOST:g}")
