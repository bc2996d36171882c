"""The features of a face as handles: move a brow, a corner of the mouth, the chin, and the face follows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from pliant.deformer import Controls, SpaceDeformer, Target, checked_controls
from pliant.errors import InvalidDeformer
from pliant.face.features import handles_of, sites
from pliant.mesh import Points, as_points
from pliant.numerics.ragged import frozen
from pliant.space.dirichlet_ffd import DirichletFFD
from pliant.space.sparse import SparseBinding

COUNT = 468


@dataclass(frozen=True, eq=False)
class FaceHandles(SpaceDeformer):
    """Named handles of a face: brows, lids, nose, lips, chin, cheeks, outline.

    Each handle takes its landmarks along, and all that lies around follows by Dirichlet free-form deformation
    (Moccozet & Magnenat-Thalmann 1997), for which the landmarks are the sites. Controls are the handles' positions, in
    the order of :data:`pliant.face.features.HANDLES`; they rest where their landmarks are on average.

    Parameters
    ----------
    landmarks
        (468, 3) of a face at rest, such as ``face.landmarks``.
    displacements
        (h, 3) of each handle; None = at rest.

    Raises
    ------
    InvalidDeformer
        Another number of landmarks, values that are not finite, two landmarks in one place.
    """

    landmarks: Points
    displacements: Controls | None = None

    def __post_init__(self) -> None:
        points = checked_landmarks(self.landmarks)
        shape = (sites()[1].shape[1], 3)
        moves = np.zeros(shape) if self.displacements is None else np.asarray(self.displacements, np.float64)
        if moves.shape != shape or not np.isfinite(moves).all():
            raise InvalidDeformer(f"displacements must be finite and of shape {shape}; theirs is {moves.shape}")
        object.__setattr__(self, "landmarks", points)
        object.__setattr__(self, "displacements", frozen(moves, np.float64))

    @cached_property
    def rest(self) -> Controls:
        """(h, 3) the mean of each handle's landmarks."""
        chosen, parts = sites()
        return frozen((parts / parts.sum(axis=0)).T @ self.landmarks[chosen], np.float64)

    @property
    def controls(self) -> Controls:
        return np.asarray(self.rest + self._moves)

    def moved(self, controls: ArrayLike) -> Self:
        other = replace(self, displacements=checked_controls(controls, self.rest.shape) - self.rest)
        other.__dict__["_sites"] = self._sites  # their cells depend on the landmarks only
        return other

    def shifted(self, moves: Mapping[str, ArrayLike]) -> Self:
        """The same handles after further shifts.

        Parameters
        ----------
        moves
            (3,) how far, by the name of a handle, or of a group whose handles all move.

        Raises
        ------
        InvalidParameter
            A name that is neither.
        """
        controls = self.controls
        for name, offset in moves.items():
            controls[handles_of(name)] += checked_controls(offset, (3,))
        return self.moved(controls)

    def bind(self, target: Target) -> SparseBinding:
        points = as_points(target)
        weights = self._sites.bind(points).matrix()
        return SparseBinding(points, weights, csr_array(sites()[1]), self.rest, self._moves)

    def jacobian(self, points: ArrayLike) -> NDArray[np.float64]:
        """(n, 3, 3) the derivative."""
        return self.sites().jacobian(points)

    def sites(self) -> DirichletFFD:
        """The same deformation with a control point for each landmark."""
        return self._sites.moved(self._sites.rest + sites()[1] @ self._moves)

    @property
    def _moves(self) -> Controls:
        assert self.displacements is not None
        return self.displacements

    @cached_property
    def _sites(self) -> DirichletFFD:
        return DirichletFFD(self.landmarks[sites()[0]])


def checked_landmarks(landmarks: ArrayLike) -> Points:
    """(468, 3) landmarks, read-only.

    Raises
    ------
    InvalidDeformer
        Another number of them, or values that are not finite.
    """
    points = np.asarray(landmarks, np.float64)
    if points.shape != (COUNT, 3) or not np.isfinite(points).all():
        raise InvalidDeformer(f"landmarks must be finite and of shape ({COUNT}, 3); theirs is {points.shape}")
    return np.asarray(frozen(points, np.float64))
