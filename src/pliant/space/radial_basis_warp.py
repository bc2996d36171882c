"""Radial basis warp: landmarks move what is near them, and nothing else (Wendland 1995)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidDeformer
from pliant.numerics.maps.radial import RadialBasis
from pliant.space.landmark_warp import LandmarkWarp

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RadialBasisWarp(LandmarkWarp):
    """A warp that ends at a distance: Wendland's C² function (1995) around each landmark.

    Parameters
    ----------
    landmarks, targets, regularization
        See :class:`~pliant.space.landmark_warp.LandmarkWarp`.
    support
        How far a landmark reaches, in the mesh's unit; beyond it nothing moves.
    """

    support: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 < self.support < np.inf:
            raise InvalidDeformer(f"the support of a landmark is {self.support}; it must be positive")

    @cached_property
    def _basis(self) -> RadialBasis:
        return RadialBasis(self.rest, 1 / self.support, compact=True)

    @property
    def _polynomials(self) -> Floats:
        return np.empty((4, 0))
