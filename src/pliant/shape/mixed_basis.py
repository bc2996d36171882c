"""Fields Q M of other fields Q: what conditioning makes, without touching the points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import DTypeLike, NDArray

from pliant.shape.basis import Basis, Floats, Integers, ScalarBasis, everywhere


@dataclass(frozen=True, eq=False)
class MixedBasis(Basis):
    """Fields Q M of another basis; M is (r, j) where all is scalar, else (k, j)."""

    base: Basis
    matrix: Floats
    deviations: Floats

    @property
    def scalar(self) -> bool:  # type: ignore[override]
        return self.base.scalar and len(self.matrix) == self.base.rank

    @property
    def size(self) -> int:
        """n, the number of points."""
        return self.base.size

    def apply(
        self, coefficients: Floats, dtype: DTypeLike = np.float64, base: Floats | None = None
    ) -> NDArray[np.floating]:
        return self.base.apply(self.mixed(coefficients), dtype, base)

    def mixed(self, coefficients: Floats) -> Floats:
        """(..., k) coefficients of the other basis."""
        if not self.scalar:
            return np.asarray(coefficients @ self.matrix.T)
        shape = coefficients.shape[:-1]
        return np.asarray((self.matrix @ coefficients.reshape(*shape, self.rank, 3)).reshape(*shape, -1))

    def transpose(self, values: Floats) -> Floats:
        inner = self.base.transpose(values)
        return np.asarray((self.matrix.T @ (inner.reshape(-1, 3) if self.scalar else inner)).reshape(-1))

    def rows(self, chosen: Integers, weights: Floats | None = None) -> Basis:
        return MixedBasis(self.base.rows(chosen, weights), self.matrix, self.deviations)

    def gram(self, precision: Floats) -> Floats:
        inner = self.base.gram(precision)
        matrix = self.matrix
        if len(inner) != len(matrix):
            matrix, inner = _alike(matrix, inner)
        return np.asarray(matrix.T @ inner @ matrix)

    def combined(self, matrix: Floats, deviations: Floats) -> Basis:
        own = self.matrix
        if self.scalar and len(matrix) != self.rank:
            own = everywhere(own)
        return MixedBasis(self.base, own @ matrix, deviations)

    def columns(self) -> Floats:
        matrix = everywhere(self.matrix) if self.scalar else self.matrix
        flat = self.base.columns().reshape(3 * self.size, -1)
        return np.asarray(flat @ matrix).reshape(self.size, 3, -1)

    def covariances(self) -> Floats:
        if not isinstance(self.base, ScalarBasis) or not self.scalar:
            return super().covariances()
        return ScalarBasis(self.base.factors @ self.matrix, self.deviations).covariances()

    def freeze(self) -> None:
        self.base.freeze()
        self.matrix.flags.writeable = False


def _alike(matrix: Floats, inner: Floats) -> tuple[Floats, Floats]:
    """A scalar matrix beside one of all coordinates: what is scalar is written out."""
    if len(inner) < len(matrix):
        return matrix, everywhere(inner)
    return everywhere(matrix), inner
