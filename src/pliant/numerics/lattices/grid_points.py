"""Points in a grid of nodes, for trilinear interpolation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.compute.chunks import for_chunks

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class GridPoints:
    """Trilinear interpolation at points; the same questions as :class:`pliant.numerics.lattices.cells.CellPoints`.

    Parameters
    ----------
    shape
        (3,) numbers of nodes, each at least 2.
    frame
        (3, 4) maps positions to grid coordinates: node i of an axis lies at i.
    keep
        (2, 3) grid coordinates beyond which a point gets nothing.
    points
        (n, 3) float64, C order, finite; kept, not copied.
    """

    def __init__(self, shape: tuple[int, int, int], frame: Floats, keep: Floats, points: Floats) -> None:
        self.points = points
        self._shape, self._frame, self._keep = np.array(shape, np.int64), frame, keep

    @property
    def outside(self) -> Integers:
        """The points beyond ``keep``, ascending."""
        q = self.points @ self._frame[:, :3].T + self._frame[:, 3]
        return np.flatnonzero(((q < self._keep[0]) | (q > self._keep[1])).any(axis=1))

    def evaluate(self, lattice: Floats, base: Floats, out: Floats) -> None:
        """out (n, 3) = base (n, 3) + the interpolated (x, y, z, 3) values."""
        from pliant.numerics.lattices import trilinear

        flat, base, target = lattice.reshape(-1), base.reshape(-1), out.reshape(-1)
        points = self.points.reshape(-1)

        def work(start: int, stop: int) -> None:
            trilinear.evaluate(points, start, stop, self._frame, self._keep, flat, self._shape, base, target)

        for_chunks(work, len(self.points))

    def jacobian(self, lattice: Floats, linear: Floats) -> Floats:
        """(n, 3, 3) ``linear`` (3, 3) + the derivative with respect to position."""
        from pliant.numerics.lattices import trilinear

        result = np.tile(linear, (len(self.points), 1, 1))
        points, flat, target = self.points.reshape(-1), lattice.reshape(-1), result.reshape(-1)

        def work(start: int, stop: int) -> None:
            trilinear.differentiate(points, start, stop, self._frame, self._keep, flat, self._shape, target)

        for_chunks(work, len(self.points))
        return result

    def transpose(self, values: Floats) -> Floats:
        """(x, y, z, 3) the transpose of :meth:`evaluate` applied to (n, 3) values."""
        columns, weights = self.basis_values()
        size = int(self._shape.prod())
        sums = [np.bincount(columns.reshape(-1), (weights * v[:, None]).reshape(-1), size) for v in values.T]
        return np.ascontiguousarray(np.stack(sums, axis=-1).reshape(*self._shape, 3))

    def column(self, selected: tuple[Floats, Floats, Floats]) -> tuple[NDArray[np.int32], Floats]:
        """The points that one control reaches, given by its share in the values of each axis; and its weights."""
        columns, weights = self.basis_values()
        i, j, k = np.unravel_index(columns, tuple(self._shape))
        weight = (weights * selected[0][i] * selected[1][j] * selected[2][k]).sum(axis=1)
        reached = np.flatnonzero(weight)
        return reached.astype(np.int32), weight[reached]

    def basis_values(self) -> tuple[Integers, Floats]:
        """Which nodes each point uses and their weights: (n, 8) flat indices and (n, 8) factors."""
        from pliant.numerics.lattices import trilinear

        columns, weights = np.empty((len(self.points), 8), np.int64), np.empty((len(self.points), 8))
        points, flat, factors = self.points.reshape(-1), columns.reshape(-1), weights.reshape(-1)

        def work(start: int, stop: int) -> None:
            trilinear.basis(points, start, stop, self._frame, self._keep, self._shape, flat, factors)

        for_chunks(work, len(self.points))
        return columns, weights
