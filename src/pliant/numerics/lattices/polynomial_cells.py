"""A displacement field that is one tensor-product polynomial in each cell of a grid: B-spline and Bézier lattices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Rational = list[list[Fraction]]

CUBIC = np.array([[1, 4, 1, 0], [0, 4, 2, 0], [0, 2, 4, 0], [0, 1, 4, 1]]) / 6
"""Bernstein coefficients of a cell, as rows, from the four values of a uniform cubic B-spline."""

QUADRATIC = np.array([[1, 1, 0], [0, 2, 0], [0, 1, 1]]) / 2
"""Likewise from the three values of a uniform quadratic B-spline."""


@dataclass(frozen=True, eq=False)
class PolynomialCells:
    """The map x' = A x + t + u(F x + f), where u is a tensor-product polynomial in each cell of a grid.

    Parameters
    ----------
    values
        (x, y, z, 3) control values of u.
    frame
        (3, 4) F and f: from positions to grid coordinates, where cell i of an axis is [i, i + 1].
    linear
        (3, 3) A.
    degrees
        (3,) of the polynomials along each axis.
    stride
        (3,) control values from one cell to the next.
    splines
        Whether the values are those of uniform cubic B-splines; else they are Bernstein coefficients.
    whole
        Whether the map is that of the cells and x' = A x + t, up to a translation, everywhere else; if not, nothing
        is known beyond the cells.
    continuous
        Whether it is known to be continuous in all of space.
    """

    values: Floats
    frame: Floats
    linear: Floats
    degrees: tuple[int, int, int]
    stride: tuple[int, int, int]
    splines: bool
    whole: bool = True
    continuous: bool = True

    @property
    def counts(self) -> tuple[int, int, int]:
        """(3,) numbers of cells."""
        sizes = zip(self.values.shape[:3], self.degrees, self.stride, strict=True)
        x, y, z = ((size - degree - 1) // step + 1 for size, degree, step in sizes)
        return x, y, z

    def slopes(self, axis: int, cells: Integers) -> tuple[Floats, Floats]:
        """The derivative of u along a grid axis, in k cells.

        Returns
        -------
        coefficients
            (k, 3, ...) in Bernstein form; the degree along the axis is one less than that of u.
        largest
            (k, 3) absolute value of the control values, differences of neighbouring values times the degree. The
            coefficients are means of them, with positive weights.
        """
        sizes = list(self.slope_sizes(axis))
        if not self.degrees[axis]:
            return np.zeros((len(cells), 3, *sizes)), np.zeros((len(cells), 3))
        window = np.moveaxis(self._windows(self._differences(axis), sizes, cells), 4, 1)
        largest = np.abs(window).max(axis=(2, 3, 4))
        if self.splines:
            for other in range(3):
                change = QUADRATIC if other == axis else CUBIC
                window = np.moveaxis(np.moveaxis(window, 2 + other, 4) @ change.T, 4, 2 + other)
        return np.ascontiguousarray(window), largest

    def slope_sizes(self, axis: int) -> tuple[int, int, int]:
        """(3,) numbers of coefficients that :meth:`slopes` has along each axis."""
        x, y, z = (max(n, 1) if other == axis else n + 1 for other, n in enumerate(self.degrees))
        return x, y, z

    def slope_range(self, axis: int, cells: Integers) -> tuple[Floats, Floats]:
        """(k, 3) bounds of the derivative of u along a grid axis: its control values' least and greatest."""
        if not self.degrees[axis]:
            return np.zeros((len(cells), 3)), np.zeros((len(cells), 3))
        window = self._windows(self._differences(axis), list(self.slope_sizes(axis)), cells)
        return window.min(axis=(1, 2, 3)), window.max(axis=(1, 2, 3))

    def _differences(self, axis: int) -> Floats:
        """Control values of the derivative along an axis."""
        degree = 1 if self.splines else self.degrees[axis]
        return np.asarray(degree * np.diff(self.values, axis=axis))

    def _windows(self, values: Floats, sizes: list[int], cells: Integers) -> Floats:
        """(k, ..., 3) the control values that some cells use."""
        corners = np.unravel_index(cells, self.counts)
        rows = [
            np.arange(size) + step * at[:, None] for size, step, at in zip(sizes, self.stride, corners, strict=True)
        ]
        x, y, z = rows
        return np.asarray(values[x[:, :, None, None], y[:, None, :, None], z[:, None, None, :]])

    def position(self, cell: int, local: Floats) -> Floats:
        """(3,) where in space a place (3,) in [0, 1]^3 of a cell is."""
        place = np.array(np.unravel_index(cell, self.counts)) + local
        return np.asarray(np.linalg.solve(self.frame[:, :3], place - self.frame[:, 3]))

    def exact_determinant(self, cell: int, local: Sequence[float]) -> Fraction:
        """det J at a place in a cell, in rational arithmetic: without any rounding."""
        corner = [int(i) for i in np.unravel_index(cell, self.counts)]
        starts = [step * at for step, at in zip(self.stride, corner, strict=True)]
        weights = [self._exact_weights(axis, Fraction(t)) for axis, t in enumerate(local)]
        spans = tuple(slice(start, start + n + 1) for start, n in zip(starts, self.degrees, strict=True))
        window = self.values[spans]
        slopes = [[_contract(window[..., c], weights, axis) for axis in range(3)] for c in range(3)]
        columns = list(zip(*rational(self.frame[:, :3]), strict=True))
        linear = rational(self.linear)
        return determinant([[linear[c][j] + dot(slopes[c], columns[j]) for j in range(3)] for c in range(3)])

    def _exact_weights(self, axis: int, t: Fraction) -> tuple[list[Fraction], list[Fraction]]:
        """The basis functions along an axis, and their slopes."""
        if self.splines:
            s = 1 - t
            values = [s**3 / 6, (3 * t**3 - 6 * t**2 + 4) / 6, (3 * s**3 - 6 * s**2 + 4) / 6, t**3 / 6]
            return values, [-(s**2) / 2, (3 * t**2 - 4 * t) / 2, (4 * s - 3 * s**2) / 2, t**2 / 2]
        n = self.degrees[axis]
        lower = [Fraction(0), *_exact_bernstein(n - 1, t), Fraction(0)] if n else [Fraction(0)] * 2
        return _exact_bernstein(n, t), [n * (lower[i] - lower[i + 1]) for i in range(n + 1)]


def rational(matrix: Floats) -> Rational:
    """A matrix of floats as the fractions that they are."""
    return [[Fraction(float(value)) for value in row] for row in matrix]


def dot(one: Sequence[Fraction], other: Sequence[Fraction]) -> Fraction:
    """The sum of the products of fractions."""
    return sum((a * b for a, b in zip(one, other, strict=True)), Fraction(0))


def determinant(matrix: Rational) -> Fraction:
    """The determinant of a (3, 3) matrix of fractions."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def inverse(matrix: Rational) -> Rational:
    """The inverse of a (3, 3) matrix of fractions that is not singular."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    whole = determinant(matrix)
    adjugate = [
        [e * i - f * h, c * h - b * i, b * f - c * e],
        [f * g - d * i, a * i - c * g, c * d - a * f],
        [d * h - e * g, b * g - a * h, a * e - b * d],
    ]
    return [[entry / whole for entry in row] for row in adjugate]


def _exact_bernstein(degree: int, t: Fraction) -> list[Fraction]:
    return [comb(degree, i) * t**i * (1 - t) ** (degree - i) for i in range(degree + 1)]


def _contract(window: Floats, weights: list[tuple[list[Fraction], list[Fraction]]], along: int) -> Fraction:
    """The sum over a cell's values, by slopes along one axis and by values along the others."""
    x, y, z = (weights[axis][int(axis == along)] for axis in range(3))
    total = Fraction(0)
    for i, plane in enumerate(window):
        for j, row in enumerate(plane):
            total += x[i] * y[j] * dot(z, [Fraction(float(value)) for value in row])
    return total
