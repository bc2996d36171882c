"""Sections that turn and grow, but stay where they are: twist, taper and flare.

x' = r R(theta) (u, v), s' = s with r and theta functions of s; det J = r^2, and the inverse is written down.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import NotConverged
from pliant.mesh import Points, as_points
from pliant.numerics.maps.sections import Entries, similar, similar_jacobians
from pliant.space.axial import AxialDeformer, Numbers
from pliant.space.profile import Curve

Floats = NDArray[np.float64]
Rule = tuple[Curve, float, float]


@dataclass(frozen=True, eq=False, kw_only=True)
class SimilarDeformer(AxialDeformer):
    """A deformation whose sections turn about the axis and grow from it."""

    @abstractmethod
    def _turn(self, q: Floats, numbers: Numbers) -> tuple[Any, Any]:
        """The factor r and the angle theta of the sections q."""

    @abstractmethod
    def _turn_slopes(self, q: Floats) -> tuple[Any, Any]:
        """Their derivatives by q."""

    @property
    @abstractmethod
    def _rule(self) -> Rule | None:
        """A piecewise cubic h, an angle and a growth with r = 1 + growth h, theta = angle h; None: there is none."""

    def _table(self, q: Floats, numbers: Numbers) -> Entries:
        r, theta = self._turn(q, numbers)
        along, across = r * np.cos(theta), r * np.sin(theta)
        return {(0, 1): along - 1, (0, 2): -across, (1, 1): across, (1, 2): along - 1}

    def _slopes(self, q: Floats) -> Entries:
        r, theta = self._turn(q, self.controls)
        grows, turns = self._turn_slopes(q)
        cosine, sine = np.cos(theta), np.sin(theta)
        along, across = grows * cosine - r * sine * turns, grows * sine + r * cosine * turns
        return {(0, 1): along, (0, 2): -across, (1, 1): across, (1, 2): along}

    def _move(self, points: Points, out: Points) -> bool:
        rule = self._rule
        if rule is None:
            return super()._move(points, out)
        return similar(points, self._frame, self._ramp(rule[0]), *rule[1:], out)

    def jacobian(self, points: ArrayLike) -> Floats:
        rule = self._rule
        if rule is None:
            return super().jacobian(points)
        return similar_jacobians(as_points(points, borrow=True), self._frame, self._ramp(rule[0]), *rule[1:])

    def inverse(self, points: ArrayLike, *, tolerance: float = 1e-10, iterations: int = 50) -> Points:
        """Where (n, 3) points came from, exactly: the tolerance is not needed.

        Raises
        ------
        NotConverged
            Sections that have shrunk to a point.
        """

        def entries(q: Floats) -> Entries:
            r, theta = self._turn(q, self.controls)
            if np.any(r == 0):
                raise NotConverged(
                    f"{type(self).__name__} shrinks a section to a point: what lies there has no inverse; keep the "
                    "factors away from zero"
                )
            along, across = np.cos(theta) / r, np.sin(theta) / r
            return {(0, 1): along - 1, (0, 2): across, (1, 1): -across, (1, 2): along - 1}

        return self._undone(points, entries)

    def _ramp(self, curve: Curve) -> tuple[Floats, Floats]:
        scale = 1 / self._width
        return np.array([scale, -self.bounds[0] * scale]), curve.pieces
