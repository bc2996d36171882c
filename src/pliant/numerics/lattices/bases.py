"""Bernstein polynomials of any degree, and points ready for their trivariate tensor products."""

from __future__ import annotations

from math import comb

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.ragged import source

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


def binomials(degree: int) -> Floats:
    """(degree + 1,) the binomial coefficients of a degree."""
    return np.array([comb(degree, i) for i in range(degree + 1)], np.float64)


def bernstein(degree: int, t: Floats) -> Floats:
    """(k, degree + 1) Bernstein polynomials at (k,) parameters, also outside [0, 1]."""
    i = np.arange(degree + 1)
    return np.asarray(binomials(degree) * t[:, None] ** i * (1 - t[:, None]) ** (degree - i))


class BernsteinPoints:
    """Points in one hyperpatch of any degree; the same questions as :class:`pliant.numerics.lattices.cells.CellPoints`.

    Parameters
    ----------
    shape
        (3,) numbers of control values: the degrees plus one.
    frame
        (3, 4) maps positions to parameters.
    keep
        (2, 3) parameters beyond which the sum is zero.
    points
        (n, 3) float64, C order, finite; kept, not copied.
    """

    def __init__(self, shape: tuple[int, int, int], frame: Floats, keep: Floats, points: Floats) -> None:
        self.shape, self.points = shape, points
        self._frame, self._keep = frame, keep

    @property
    def outside(self) -> Integers:
        """The points beyond ``keep``, ascending."""
        t = self._parameters(slice(None))
        return np.flatnonzero(((t < self._keep[0]) | (t > self._keep[1])).any(axis=1))

    def evaluate(self, lattice: Floats, base: Floats, out: Floats) -> None:
        """out (n, 3) = base (n, 3) + the sum over an (l + 1, m + 1, n + 1, 3) lattice."""
        from pliant.numerics.lattices import bernstein as compiled

        counts = [binomials(size - 1) for size in lattice.shape[:3]]
        flat, target = source(np.ascontiguousarray(lattice).reshape(-1)), out.reshape(-1)
        points, base = source(self.points.reshape(-1)), source(base.reshape(-1))

        def work(start: int, stop: int) -> None:
            compiled.evaluate(points, start, stop, self._frame, self._keep, *counts, flat, base, target)

        for_chunks(work, len(self.points), 16_384)

    def jacobian(self, lattice: Floats, linear: Floats) -> Floats:
        """(n, 3, 3) ``linear`` (3, 3) + the derivative of the sum with respect to position, by hodographs."""
        result = np.tile(linear, (len(self.points), 1, 1))
        slope, nothing = np.empty_like(self.points), np.zeros_like(self.points)
        for axis in range(3):
            degree = lattice.shape[axis] - 1
            if degree:
                self.evaluate(degree * np.diff(lattice, axis=axis), nothing, slope)
                result += slope[:, :, None] * self._frame[axis, :3]
        return result

    def transpose(self, values: Floats) -> Floats:
        """(l + 1, m + 1, n + 1, 3) the transpose of :meth:`evaluate` applied to (n, 3) values."""
        piece = 8_192
        sums = np.zeros((min(8, -(-len(self.points) // piece)), *self.shape, 3))

        def work(start: int, stop: int) -> None:
            for group in range(start, stop):
                for first in range(group * piece, len(self.points), piece * len(sums)):
                    part = slice(first, first + piece)
                    x, y, z = self._bases(part)
                    across = np.einsum("ni,nj->nij", x, y).reshape(len(x), -1)
                    along = np.einsum("nk,nc->nkc", z, values[part]).reshape(len(x), -1)
                    sums[group] += (across.T @ along).reshape(sums[group].shape)

        for_chunks(work, len(sums), 1)
        return np.asarray(sums.sum(axis=0))

    def column(self, selected: tuple[Floats, Floats, Floats]) -> tuple[NDArray[np.int32], Floats]:
        """The points that one control reaches, given by its share in the values of each axis; and its weights."""
        x, y, z = self._bases(slice(None))
        weights = (x @ selected[0]) * (y @ selected[1]) * (z @ selected[2])
        reached = np.flatnonzero(weights)
        return reached.astype(np.int32), weights[reached]

    def basis_values(self) -> tuple[Integers, Floats]:
        """Which control values each point uses and their weights: (n, m) flat indices and (n, m) factors."""
        x, y, z = self._bases(slice(None))
        weights = np.einsum("ni,nj,nk->nijk", x, y, z).reshape(len(x), -1)
        return np.broadcast_to(np.arange(weights.shape[1]), weights.shape), weights

    def _parameters(self, part: slice) -> Floats:
        return np.asarray(self.points[part] @ self._frame[:, :3].T + self._frame[:, 3])

    def _bases(self, part: slice) -> list[Floats]:
        """Bernstein polynomials along the three axes; zero along the first for points beyond ``keep``."""
        t = self._parameters(part)
        bases = [bernstein(size - 1, t[:, axis]) for axis, size in enumerate(self.shape)]
        bases[0][((t < self._keep[0]) | (t > self._keep[1])).any(axis=1)] = 0.0
        return bases
