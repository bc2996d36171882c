"""Thin-plate spline: the smoothest warp through landmarks (Bookstein 1989, in space: phi(r) = r)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.maps.radial import RadialBasis
from pliant.space.landmark_warp import LandmarkWarp

Floats = NDArray[np.float64]

FLAT = 1e-9  # extent of the landmarks, relative to the largest, below which they say nothing of that direction


@dataclass(frozen=True, eq=False)
class ThinPlateSpline(LandmarkWarp):
    """The smoothest warp through landmarks: of all that carry them to their targets it bends space least.

    It is Bookstein's (1989) in space. Where the landmarks move affinely, all space does. Landmarks in a plane, or on a
    line, say nothing of the other directions: there the affine part keeps things as they are.

    Parameters
    ----------
    landmarks, targets, regularization
        See :class:`~pliant.space.landmark_warp.LandmarkWarp`.
    """

    @cached_property
    def _basis(self) -> RadialBasis:
        return RadialBasis(self.rest, 1 / self._frame[1], compact=False)

    @cached_property
    def _polynomials(self) -> Floats:
        center, size, directions = self._frame
        linear = directions / size
        constant = np.array([[0.0], [0.0], [0.0], [1.0]])
        return np.hstack([np.vstack([linear, -center @ linear]), constant])

    @cached_property
    def _frame(self) -> tuple[Floats, float, Floats]:
        """Centre and extent of the landmarks, and (3, d) the directions in which they extend."""
        center = self.rest.mean(axis=0)
        extents, directions = np.linalg.svd(self.rest - center, full_matrices=False)[1:]
        extended = extents > FLAT * max(float(extents[0]), 1e-300)
        size = float(np.linalg.norm(np.ptp(self.rest, axis=0))) or 1.0
        return center, size, directions[extended].T
