"""A caricature as a deformer with a number for each feature: what sliders move, and keys in time."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Binding, Controls, SpaceDeformer, Target, checked_controls, checked_out
from pliant.errors import InvalidDeformer
from pliant.face.features import GROUPS, group_of_sites, sites
from pliant.face.handles import checked_landmarks
from pliant.face.identity import difference_from_mean
from pliant.mesh import Points, as_points
from pliant.space.dirichlet_ffd import DirichletFFD

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FaceCaricature(SpaceDeformer):
    """What sets a face apart from the mean, exaggerated feature by feature (Brennan 1985, "Caricature generator").

    Landmarks of a feature go to p + amount · gain · (p − mean), and all that lies around follows by the smooth form of
    Dirichlet free-form deformation, as in :func:`pliant.caricature`, which also ends before anything folds. At rest,
    with no amount, a face is as it is. Controls are the amount and the gains, in the order of the fields.

    Parameters
    ----------
    landmarks
        (468, 3) of a face at rest, such as ``face.landmarks``.
    amount
        How far from the mean: 0 leaves the face, 1 doubles its difference, −1 gives the mean face.
    brows, eyes, nose, mouth, chin, cheeks, outline
        How much each feature is exaggerated, next to the others; 1 = as much as all.
    expression
        How much of the expression is exaggerated along: 0 = a smile stays as it is.

    Raises
    ------
    InvalidDeformer
        Another number of landmarks, or values that are not finite.
    """

    parameters: ClassVar[tuple[str, ...]] = ("amount", *GROUPS)

    landmarks: Points
    amount: float = field(default=0.0, metadata={"range": (-1.0, 2.0)})
    brows: float = 1.0
    eyes: float = 1.0
    nose: float = 1.0
    mouth: float = 1.0
    chin: float = 1.0
    cheeks: float = 1.0
    outline: float = 1.0
    expression: float = field(default=0.0, metadata={"range": (0.0, 1.0)})

    def __post_init__(self) -> None:
        object.__setattr__(self, "landmarks", checked_landmarks(self.landmarks))
        for name in (*self.parameters, "expression"):
            value = float(getattr(self, name))
            if not np.isfinite(value):
                raise InvalidDeformer(f"{name} is {value}; it must be finite")
            object.__setattr__(self, name, value)

    @property
    def rest(self) -> Controls:
        """(8,) no amount, all features alike."""
        return np.array([0.0] + [1.0] * len(GROUPS))

    @property
    def controls(self) -> Controls:
        """(8,) the amount, and the gain of each feature."""
        return np.array([getattr(self, name) for name in self.parameters])

    def moved(self, controls: ArrayLike) -> Self:
        values = checked_controls(controls, (1 + len(GROUPS),)).tolist()
        other = replace(self, **dict(zip(self.parameters, values, strict=True)))
        other.__dict__["_sites"] = self._sites  # their cells depend on the landmarks only
        return other

    def bind(self, target: Target) -> CaricatureBinding:
        points = as_points(target)
        weights = self._sites.bind(points).matrix()
        fields = np.stack([np.asarray(weights @ each) for each in self._fields])
        return CaricatureBinding(points, fields, self.controls)

    def jacobian(self, points: ArrayLike) -> Floats:
        return self.sites().jacobian(points)

    def sites(self) -> DirichletFFD:
        """The same deformation with a control point for each landmark of a feature."""
        amount, gains = self.controls[0], self.controls[1:]
        return self._sites.moved(self._sites.rest + amount * np.tensordot(gains, self._fields, axes=1))

    @cached_property
    def _sites(self) -> DirichletFFD:
        return DirichletFFD(self.landmarks[sites()[0]], smooth=True)

    @cached_property
    def _fields(self) -> Floats:
        """(g, k, 3) how the landmarks that are moved differ from the mean, by feature."""
        parts = difference_from_mean(self.landmarks)
        wanted = (parts.identity + self.expression * parts.expression)[sites()[0]]
        return np.asarray(group_of_sites().T[:, :, None] * wanted)


class CaricatureBinding(Binding):
    """Points that move with an amount and gains: x' = x + amount Σ gain_g u_g(x).

    Parameters
    ----------
    points
        (n, 3) the target's.
    fields
        (g, n, 3) the displacement u of each feature.
    controls
        (1 + g,) the deformer's own.
    """

    def __init__(self, points: Points, fields: Floats, controls: Controls) -> None:
        self._points, self._fields, self._controls = points, fields, controls

    @property
    def rest(self) -> Controls:
        return np.array([0.0] + [1.0] * len(self._fields))

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        amount, *gains = self._checked(controls)
        target = checked_out(out, len(self._points))
        np.add(self._points, amount * np.tensordot(gains, self._fields, axes=1), out=target)
        return target

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        now, change = self._checked(controls), checked_controls(d_controls, self._controls.shape)
        return np.asarray(np.tensordot(change[0] * now[1:] + now[0] * change[1:], self._fields, axes=1))

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        now = self._checked(controls)
        each = np.tensordot(self._fields, checked_controls(d_points, self._points.shape), axes=2)
        return np.concatenate([[now[1:] @ each], now[0] * each])
