"""The fields of a model at its points, u = sum_j a_j ψ_j, in the form in which they take least room.

Coefficients are flat, (k,), each standard normal. A scalar basis of rank r has k = 3 r of them: number 3 j + c moves
coordinate c along field j.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import DTypeLike, NDArray

from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.compute.one_thread import one_blas_thread

Floats = NDArray[np.float64]
Integers = NDArray[np.integer]

_BLOCK = 262_144  # numbers of one coordinate that are made at once
_FEW = 4  # shapes that are made one by one


class Basis(ABC):
    """k fields at n points."""

    scalar: bool
    deviations: Floats  # (r,) or (k,) standard deviations, as the eigenvalues tell them

    @property
    @abstractmethod
    def size(self) -> int:
        """n, the number of points."""

    @property
    def rank(self) -> int:
        """How many fields there are; a scalar one counts once."""
        return len(self.deviations)

    @property
    def count(self) -> int:
        """k, the number of coefficients."""
        return (3 if self.scalar else 1) * self.rank

    @abstractmethod
    def apply(
        self, coefficients: Floats, dtype: DTypeLike = np.float64, base: Floats | None = None
    ) -> NDArray[np.floating]:
        """(..., n, 3) displacements for (..., k) coefficients, on top of (n, 3) points if these are given."""

    @abstractmethod
    def transpose(self, values: Floats) -> Floats:
        """(k,) the inner products of the fields with (n, 3) values."""

    @abstractmethod
    def rows(self, chosen: Integers, weights: Floats | None = None) -> Basis:
        """The fields at some points (m,), or at combinations of points (m, c) with weights (m, c)."""

    @abstractmethod
    def gram(self, precision: Floats) -> Floats:
        """Qᵀ P Q with a precision (n,) or (n, 3, 3) a point: (r, r) where all is scalar, else (k, k)."""

    def combined(self, matrix: Floats, deviations: Floats) -> Basis:
        """The fields Q M: (k, j) or, for scalar ones, (r, j) matrices."""
        from pliant.shape.mixed_basis import MixedBasis

        return MixedBasis(self, matrix, deviations)

    @abstractmethod
    def columns(self) -> Floats:
        """(n, 3, k) all fields."""

    @abstractmethod
    def freeze(self) -> None:
        """Make the numbers read-only, so that what depends on them can be known by them."""

    def covariances(self) -> Floats:
        """(n, 3, 3) of each point."""
        columns = self.columns()
        return np.asarray(columns @ columns.transpose(0, 2, 1))

    def turned(self, linear: Floats) -> FullBasis:
        """The fields after a linear map of space."""
        deviations = np.repeat(self.deviations, 3) if self.scalar else self.deviations
        return FullBasis(linear @ self.columns(), deviations)


@dataclass(frozen=True, eq=False)
class ScalarBasis(Basis):
    """Scalar fields ψ (n, r), one for all coordinates."""

    factors: Floats
    deviations: Floats

    scalar = True

    @property
    def size(self) -> int:
        """n, the number of points."""
        return len(self.factors)

    def apply(
        self, coefficients: Floats, dtype: DTypeLike = np.float64, base: Floats | None = None
    ) -> NDArray[np.floating]:
        shape = (*coefficients.shape[:-1], self.size, 3)
        stacked = coefficients.reshape(math.prod(shape[:-2]), self.rank, 3).astype(dtype, copy=False)
        if len(stacked) >= _FEW:
            return many(self.factors, stacked, base).reshape(shape)
        factors, out = self.factors.astype(dtype, copy=False), np.empty((len(stacked), self.size, 3), dtype)
        for each, result in zip(stacked, out, strict=True):
            np.matmul(factors, each, out=result)
            if base is not None:
                result += base
        return out.reshape(shape)

    def transpose(self, values: Floats) -> Floats:
        return np.asarray((self.factors.T @ values).reshape(-1))

    def rows(self, chosen: Integers, weights: Floats | None = None) -> ScalarBasis:
        return ScalarBasis(_rows(self.factors, chosen, weights), self.deviations)

    def gram(self, precision: Floats) -> Floats:
        """(r, r) for one precision a point, else (3 r, 3 r)."""
        if precision.ndim == 1:
            return np.asarray(self.factors.T @ (precision[:, None] * self.factors))
        weighted = (precision[:, None] * self.factors[:, :, None, None]).reshape(self.size, -1)
        gram = (self.factors.T @ weighted).reshape(self.rank, self.rank, 3, 3)
        return np.asarray(gram.transpose(0, 2, 1, 3).reshape(self.count, self.count))

    def freeze(self) -> None:
        self.factors.flags.writeable = False

    def columns(self) -> Floats:
        result = np.zeros((self.size, 3, self.rank, 3))
        for axis in range(3):
            result[:, axis, :, axis] = self.factors
        return result.reshape(self.size, 3, -1)

    def covariances(self) -> Floats:
        return np.asarray(np.einsum("nj,nj->n", self.factors, self.factors)[:, None, None] * np.eye(3))


@dataclass(frozen=True, eq=False)
class FullBasis(Basis):
    """Fields ψ as vectors, (n, 3, k)."""

    fields: Floats
    deviations: Floats

    scalar = False

    @property
    def size(self) -> int:
        """n, the number of points."""
        return len(self.fields)

    @property
    def _flat(self) -> Floats:
        return self.fields.reshape(3 * self.size, self.rank)

    def apply(
        self, coefficients: Floats, dtype: DTypeLike = np.float64, base: Floats | None = None
    ) -> NDArray[np.floating]:
        shape = (*coefficients.shape[:-1], self.size, 3)
        stacked = coefficients.reshape(math.prod(shape[:-2]), self.count).astype(dtype, copy=False)
        result = np.asarray(stacked @ self._flat.T.astype(dtype, copy=False)).reshape(shape)
        if base is not None:
            result += base.astype(dtype, copy=False)
        return result

    def transpose(self, values: Floats) -> Floats:
        return np.asarray(self._flat.T @ values.reshape(-1))

    def rows(self, chosen: Integers, weights: Floats | None = None) -> FullBasis:
        return FullBasis(_rows(self.fields, chosen, weights), self.deviations)

    def gram(self, precision: Floats) -> Floats:
        """(k, k)."""
        weighted = precision[:, None, None] * self.fields if precision.ndim == 1 else precision @ self.fields
        return np.asarray(self._flat.T @ weighted.reshape(3 * self.size, self.rank))

    def columns(self) -> Floats:
        return self.fields

    def freeze(self) -> None:
        self.fields.flags.writeable = False


def many(factors: Floats, coefficients: NDArray[np.floating], base: Floats | None) -> NDArray[np.floating]:
    """(s, n, 3) shapes of (s, r, 3) coefficients: one product a coordinate for some points of all shapes at a time."""
    count, dtype = len(coefficients), coefficients.dtype
    axes = [np.ascontiguousarray(coefficients[:, :, axis]) for axis in range(3)]
    out = np.empty((count, len(factors), 3), dtype)

    def work(first: int, stop: int) -> None:
        rows = np.ascontiguousarray(factors[first:stop].T, dtype)
        part = np.empty((count, stop - first), dtype)
        for axis in range(3):
            np.matmul(axes[axis], rows, out=part)
            if base is not None:
                part += base[first:stop, axis].astype(dtype, copy=False)
            out[:, first:stop, axis] = part

    with one_blas_thread():
        for_chunks(work, len(factors), max(16, _BLOCK // count))
    return out


def factored(fields: Floats, deviations: Floats) -> Basis:
    """The basis of (n, 3, k) fields: a scalar one, where they are those of one coordinate after the other."""
    count = len(deviations)
    if count % 3 == 0 and count:
        blocks = fields.reshape(len(fields), 3, -1, 3)
        first = np.ascontiguousarray(blocks[:, 0, :, 0])
        alike = all(np.array_equal(blocks[:, c, :, c], first) for c in (1, 2))
        if alike and not any(blocks[:, c, :, d].any() for c in range(3) for d in range(3) if c != d):
            return ScalarBasis(first, deviations[::3])
    return FullBasis(fields, deviations)


def everywhere(matrix: Floats) -> Floats:
    """A matrix of scalar coefficients as one of the coefficients of all three coordinates."""
    return np.asarray(np.kron(matrix, np.eye(3)), np.float64)


def _rows(values: Floats, chosen: Integers, weights: Floats | None) -> Floats:
    if weights is None:
        return values[chosen]
    return np.asarray(np.einsum("mc,mc...->m...", weights, values[chosen]))
