"""Landmark warps: landmarks go where they are put, and space follows smoothly.

f(x) = x + sum_i w_i phi(|x - p_i|) + A x + t with the landmarks p_i; the w_i, A and t follow from the landmarks'
displacements by one linear system, made and factorised once (Bookstein 1989; Wendland 1995).
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse.linalg import LinearOperator

from pliant.deformer import (
    Controls,
    LinearBinding,
    SpaceDeformer,
    Target,
    checked_controls,
    checked_out,
    require_finite,
)
from pliant.errors import InvalidDeformer
from pliant.mesh import Points, as_points
from pliant.numerics.given import as_number, as_numbers
from pliant.numerics.maps.radial import RadialBasis
from pliant.numerics.ragged import frozen
from pliant.space.landmark_system import LandmarkSystem
from pliant.space.lattice import by_threes
from pliant.space.point_binding import PointBinding

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LandmarkWarp(SpaceDeformer):
    """A warp that carries landmarks to targets. Its controls are the targets, (k, 3); at rest they are the landmarks.

    Parameters
    ----------
    landmarks
        (k, 3) where the landmarks rest: no two at the same place.
    targets
        (k, 3) where they are; None = at rest.
    regularization
        0: landmarks reach their targets exactly. Above: they may miss them, for a smoother warp; a pure number, of
        the order of the tolerated misses over the landmarks' extent.

    Raises
    ------
    InvalidDeformer
        Landmarks that coincide (they are named), none at all, numbers that are not finite.
    """

    landmarks: ArrayLike
    targets: ArrayLike | None = None
    regularization: float = 0.0

    def __post_init__(self) -> None:
        landmarks = _placed("landmarks", self.landmarks)
        targets = landmarks if self.targets is None else _placed("targets", self.targets)
        if targets.shape != landmarks.shape:
            raise InvalidDeformer(f"{len(landmarks)} landmarks have {len(targets)} targets: each needs one")
        if as_number("the regularization", self.regularization, InvalidDeformer) < 0:
            raise InvalidDeformer(f"the regularization is {self.regularization}; it must be zero or positive")
        _refuse_duplicates(landmarks)
        object.__setattr__(self, "landmarks", frozen(landmarks, np.float64))
        object.__setattr__(self, "targets", frozen(targets, np.float64))

    @property
    def rest(self) -> Controls:
        """(k, 3) the landmarks."""
        return np.asarray(self.landmarks)

    @property
    def controls(self) -> Controls:
        """(k, 3) the targets."""
        return np.asarray(self.targets)

    def moved(self, controls: ArrayLike) -> Self:
        """The same landmarks with (k, 3) other targets: what was factorised is kept."""
        new = replace(self, targets=checked_controls(controls, self.rest.shape))
        new.__dict__["_system"] = self._system
        return new

    def bind(self, target: Target) -> LandmarkBinding:
        """Keep the target's points: the sums are made as they are needed, not stored."""
        return LandmarkBinding(self._system, as_points(target), self.rest, self.controls)

    def _deformed(self, target: Target) -> Points:
        points = as_points(target, borrow=True)
        result = np.empty_like(points)
        self._system.displace(points, self.controls - self.rest, points, result)
        return require_finite(result, "landmark warp")

    def jacobian(self, points: ArrayLike) -> Floats:
        return self._system.jacobian(as_points(points, borrow=True), self.controls - self.rest)

    @cached_property
    def _system(self) -> LandmarkSystem:
        return LandmarkSystem(self._basis, self._polynomials, self.regularization)

    @property
    @abstractmethod
    def _basis(self) -> RadialBasis:
        """The radial function around the landmarks."""

    @property
    @abstractmethod
    def _polynomials(self) -> Floats:
        """(4, d) polynomials that the warp reproduces: coefficients of x, y, z and 1."""


class LandmarkBinding(PointBinding, LinearBinding):
    """Points bound to landmarks: linear in where the landmarks are."""

    def __init__(self, system: LandmarkSystem, points: Points, rest: Controls, controls: Controls) -> None:
        super().__init__(points, rest, controls)
        self._system = system

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        """(n, 3) the warped points."""
        result = checked_out(out, len(self._points))
        self._system.displace(self._points, self._checked(controls) - self._rest, self._points, result)
        return require_finite(result, "landmark warp")

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        """(n, 3) the warp is linear: the displacement that the change of the targets makes."""
        result = np.empty_like(self._points)
        change = checked_controls(d_controls, self._rest.shape)
        self._system.displace(self._points, change, np.zeros_like(result), result)
        return result

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        """(k, 3) the transpose of :meth:`jvp`."""
        return self._system.transpose(self._points, checked_controls(d_points, self._points.shape))

    @property
    def weights(self) -> LinearOperator:
        """(n, k) W, for k landmarks, each coordinate alike."""
        count, landmarks = len(self._points), len(self._rest)

        def forward(columns: Floats) -> Floats:
            return by_threes(lambda c: self.jvp(None, c), columns, count)

        def backward(columns: Floats) -> Floats:
            return by_threes(lambda p: self.vjp(None, p), columns, landmarks)

        return LinearOperator((count, landmarks), forward, backward, forward, np.float64, backward)


def _placed(name: str, values: ArrayLike) -> Floats:
    array = as_numbers(name, values, InvalidDeformer)
    if array.ndim != 2 or array.shape[1] != 3 or not len(array):
        raise InvalidDeformer(f"{name} have shape {array.shape}; (k, 3) is needed, with at least one landmark")
    bad = np.flatnonzero(~np.isfinite(array).all(axis=1))
    if len(bad):
        raise InvalidDeformer(f"{len(bad)} of {len(array)} {name} are not finite, the first is number {bad[0]}")
    return array


def _refuse_duplicates(landmarks: Floats) -> None:
    from scipy.spatial import cKDTree

    size = float(np.linalg.norm(np.ptp(landmarks, axis=0))) or 1.0
    pairs = sorted(cKDTree(landmarks).query_pairs(1e-10 * size)) if len(landmarks) > 1 else []
    if pairs:
        named = ", ".join(f"{one} and {two}" for one, two in pairs[:3]) + (", ..." if len(pairs) > 3 else "")
        raise InvalidDeformer(
            f"landmarks {named} are at the same place ({len(pairs)} such pairs): one place cannot have two targets; "
            "leave out all but one"
        )
