"""det J of a polynomial displacement as a polynomial of its own, with a bound on every rounding.

In a cell of degree n an axis, det J has degree 3n - 1. Its Bernstein coefficients are sums of products of those of
J's columns; their least and greatest bound det J in the cell. What floating-point arithmetic can have done to a
coefficient is bounded a priori: a chain of K roundings changes a sum of products by at most K u / (1 - K u) times the
same sum of absolute values (Higham 2002, lemma 3.1), in whatever order, fused or not; and that sum is at most the
permanent of the entries' largest absolute values, since the weights of a Bernstein product add up to one.
"""

from __future__ import annotations

from fractions import Fraction
from math import frexp

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.lattices.bases import binomials
from pliant.numerics.lattices.polynomial_cells import PolynomialCells, determinant, dot, inverse, rational

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

UNIT = 2.0**-53  # a rounding changes a number by at most this part of it
_ENTRY = 40  # roundings behind an entry of J: a difference, three changes of basis, degree, step, constant part
_SMALLEST = 1e-290  # beyond what underflow can have taken from numbers that are about one


class Determinants:
    """The polynomials det J of a map's cells.

    J = (A F^-1 + Du) F, where Du is the displacement's derivative in grid coordinates. Columns are scaled by powers
    of two to be about one, and so that det F is positive.

    Parameters
    ----------
    cells
        The map.
    """

    def __init__(self, cells: PolynomialCells) -> None:
        self.cells = cells
        frame, linear = rational(cells.frame[:, :3]), rational(cells.linear)
        back, size = inverse(frame), determinant(frame)
        columns = [[dot(linear[c], [row[a] for row in back]) for c in range(3)] for a in range(3)]
        powers = [Fraction(2) ** -frexp(float(max(map(abs, column))))[1] for column in columns]
        powers[0] = -powers[0] if size < 0 else powers[0]
        self.at_rest = determinant(linear)
        self._scale = np.array([float(power) for power in powers])
        self._constant = np.array([[float(e * p) for e in c] for c, p in zip(columns, powers, strict=True)])
        self._factor = float(size / (powers[0] * powers[1] * powers[2]))
        self._sizes = [cells.slope_sizes(axis) for axis in range(3)]
        self.shape = tuple(sum(size[axis] - 1 for size in self._sizes) + 1 for axis in range(3))
        self._roundings = 3 * _ENTRY + 8 * max(int(np.prod(size)) for size in self._sizes) + 100

    def coefficients(self, chosen: Integers, step: float = 1.0) -> tuple[Floats, Floats]:
        """(k, ...) Bernstein coefficients of det J in some cells, and (k,) by how much they may be wrong.

        ``step`` is what the displacement is multiplied by.
        """
        from pliant.numerics.lattices import bernstein_algebra

        columns, largest = [], np.empty((len(chosen), 3, 3))
        for axis in range(3):
            slopes, reach = self.cells.slopes(axis, chosen)
            scale = self._scale[axis] * step
            columns.append(self._constant[axis][:, None, None, None] + scale * slopes)
            largest[:, :, axis] = np.abs(self._constant[axis]) + abs(scale) * reach
        strides = np.array([self.shape[1] * self.shape[2], self.shape[2], 1])
        offsets = [(np.indices(size).reshape(3, -1).T @ strides).astype(np.int64) for size in self._sizes]
        first, second, third = (
            (column * _outer([binomials(n - 1) for n in size])).reshape(len(chosen), 3, -1)
            for column, size in zip(columns, self._sizes, strict=True)
        )
        spread = np.zeros((len(chosen), 3, int(offsets[1][-1]) + 1))
        spread[:, :, offsets[1]] = second
        scale = self._factor / _outer([binomials(n - 1) for n in self.shape]).reshape(-1)
        out = np.empty((len(chosen), len(scale)))

        def work(start: int, stop: int) -> None:
            bernstein_algebra.determinants(start, stop, first, spread, third, offsets[0], offsets[2], scale, out)

        for_chunks(work, len(chosen), 64)
        return out.reshape(-1, *self.shape), self._error(largest)

    def ranges(self, chosen: Integers, *, path: float | None = None) -> tuple[Floats, Floats]:
        """(k,), (k,) rough bounds of det J in some cells, from the ranges of the entries of J.

        With a ``path`` they hold for the displacement times any number from 0 to that one.
        """
        middle, radius, largest = (np.empty((len(chosen), 3, 3)) for _ in range(3))
        for axis in range(3):
            low, high = self.cells.slope_range(axis, chosen)
            if path is not None:
                low, high = path * np.minimum(low, 0.0), path * np.maximum(high, 0.0)
            scale = self._scale[axis]
            middle[:, :, axis] = self._constant[axis] + scale * (low + high) / 2
            radius[:, :, axis] = abs(scale) * (high - low) / 2
            largest[:, :, axis] = np.abs(self._constant[axis]) + abs(scale) * np.maximum(np.abs(low), np.abs(high))
        size = np.abs(middle)
        reach = self._factor * (_permanent(size + radius) - _permanent(size)) + self._error(largest)
        center = self._factor * _determinant(middle)
        return center - reach, center + reach

    def _error(self, largest: Floats) -> Floats:
        """(k,) from (k, 3, 3) sums of absolute values behind the entries of J."""
        part = self._roundings * UNIT
        return np.asarray(self._factor * (part / (1 - 2 * part) * _permanent(largest) + _SMALLEST))


def halve(coefficients: Floats, axis: int) -> tuple[Floats, Floats]:
    """Bernstein coefficients (k, ...) on the lower and the upper half of an axis (de Casteljau), as one product.

    The weights are binomial coefficients over powers of two: a coefficient changes by at most :func:`halving_error`.
    """
    degree = coefficients.shape[axis] - 1
    weights = np.zeros((degree + 1, degree + 1))
    for i in range(degree + 1):
        weights[i, : i + 1] = binomials(i) / 2.0**i
    moved = np.moveaxis(coefficients, axis, -1)
    lower, upper = moved @ weights.T, moved @ weights[::-1, ::-1].T
    return np.moveaxis(lower, -1, axis), np.moveaxis(upper, -1, axis)


def halving_error(coefficients: Floats, degree: int) -> Floats:
    """(k,) how much rounding :func:`halve` adds along an axis of some degree."""
    largest = np.abs(coefficients).max(axis=tuple(range(1, coefficients.ndim)))
    return np.asarray((degree + 8) * UNIT * 1.01 * largest)


def _outer(factors: list[Floats]) -> Floats:
    x, y, z = factors
    return np.asarray(x[:, None, None] * y[:, None] * z)


def _determinant(m: Floats) -> Floats:
    """(k,) determinants of (k, 3, 3) matrices by cofactors, whose rounding the permanent bounds."""
    return np.asarray(np.einsum("ki,ki->k", m[:, 0], np.cross(m[:, 1], m[:, 2])))


def _permanent(m: Floats) -> Floats:
    """(k,) permanents of (k, 3, 3) matrices."""
    a, b, c = m[:, 0], m[:, 1], m[:, 2]
    return np.asarray(
        a[:, 0] * (b[:, 1] * c[:, 2] + b[:, 2] * c[:, 1])
        + a[:, 1] * (b[:, 0] * c[:, 2] + b[:, 2] * c[:, 0])
        + a[:, 2] * (b[:, 0] * c[:, 1] + b[:, 1] * c[:, 0])
    )
