"""Points sorted into a grid of cells, ready for tricubic sums: the work of binding a lattice."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.ragged import source

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

CHUNKS = 32_768, 65_536  # points sorted together: what a chunk reads and writes stays in the second-level cache

BSPLINE = np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6
"""Uniform cubic B-spline: coefficient of power p in basis function b at [p, b] (Lee, Wolberg & Shin 1997, eq. 1)."""

BERNSTEIN = np.array([[1.0, 0, 0, 0], [-3, 3, 0, 0], [3, -6, 3, 0], [-1, 3, -3, 1]])
"""Cubic Bernstein polynomials, likewise."""


@dataclass(frozen=True, eq=False)
class CellGrid:
    """A grid of cells, each with 4 x 4 x 4 control values under a tricubic basis.

    Parameters
    ----------
    frame
        (3, 4) maps positions to grid coordinates: cell i of an axis is [i, i + 1].
    counts
        (3,) numbers of cells.
    stride
        Control values from one cell to the next: 1 for B-splines, 3 for Bézier patches.
    basis
        (4, 4) as :data:`BSPLINE`.
    limits
        (2, 3) what grid coordinates are clamped to; infinite where the end cells extrapolate.
    keep
        (2, 3) grid coordinates beyond which a point belongs to no cell.
    """

    frame: Floats
    counts: Integers
    stride: int
    basis: Floats
    limits: Floats
    keep: Floats

    @property
    def shape(self) -> Integers:
        """(3,) numbers of control values along each axis."""
        return np.asarray((self.counts - 1) * self.stride + 4, np.int64)

    def powers(self, lattice: Floats) -> Floats:
        """A lattice (x, y, z, 3) as the kernel that evaluates takes it: polynomials along z."""
        windows = sliding_window_view(lattice, 4, axis=2)[:, :, :: self.stride].reshape(-1, 4)
        powers = np.zeros(windows.size + 4)
        np.matmul(windows, self.basis.T, out=powers[:-4].reshape(-1, 4))
        return powers


class CellPoints:
    """Points sorted by cell; evaluates tensor products, their derivatives and their transpose there.

    Parameters
    ----------
    grid
        The cells.
    points
        (n, 3) float64, C order, finite; kept, not copied.
    """

    def __init__(self, grid: CellGrid, points: Floats) -> None:
        from pliant.numerics.lattices import tricubic

        self.grid, self.points = grid, points
        count, cells = len(points), int(grid.counts.prod())
        self._chunk = max(min(max(count // 8, CHUNKS[0]), CHUNKS[1]), 4 * cells)
        self._order, self._places = np.empty(count, np.int32), np.empty(count, np.int32)
        self._local = np.empty(3 * (count + 8))
        self._local.reshape(3, -1)[:, count:] = 0.0  # lanes beyond the last point compute too
        self._starts = np.empty((-(-count // self._chunk), cells + 2), np.int64)
        flat = source(points.reshape(-1))

        def work(start: int, stop: int) -> None:
            starts = self._starts[start // self._chunk]
            tricubic.locate(
                flat, start, stop, grid.frame, grid.limits, grid.keep, grid.counts,
                self._order, self._places, self._local, starts,
            )  # fmt: skip

        for_chunks(work, count, self._chunk)

    @property
    def outside(self) -> NDArray[np.int32]:
        """The points that belong to no cell, ascending."""
        pieces = [
            self._order[k * self._chunk + starts[-2] : k * self._chunk + starts[-1]]
            for k, starts in enumerate(self._starts)
        ]
        return np.concatenate([np.empty(0, np.int32), *pieces])

    def evaluate(self, lattice: Floats, base: Floats, out: Floats, chosen: Integers | None = None) -> None:
        """out (n, 3) = base (n, 3) + the sum over a (x, y, z, 3) lattice, in all cells or in the chosen ones."""
        from pliant.numerics.lattices import tricubic

        grid = self.grid
        cells = np.arange(grid.counts.prod()) if chosen is None else chosen
        powers, base, out = grid.powers(lattice), source(base.reshape(-1)), out.reshape(-1)

        def work(first: int, starts: Integers) -> None:
            tricubic.evaluate(
                first, starts, self._order, self._places, self._local, grid.counts, grid.stride, grid.basis,
                powers, grid.shape, cells, base, out,
            )  # fmt: skip

        self._each_chunk(work)

    def jacobian(self, lattice: Floats, linear: Floats) -> Floats:
        """(n, 3, 3) ``linear`` (3, 3) + the derivative of the sum with respect to position."""
        from pliant.numerics.lattices import tricubic

        grid, out = self.grid, np.empty((len(self.points), 3, 3))
        flat, linear, target = source(lattice.reshape(-1)), source(linear), out.reshape(-1)

        def work(first: int, starts: Integers) -> None:
            tricubic.differentiate(
                first, starts, self._order, self._local, grid.frame, grid.counts, grid.stride, grid.basis,
                flat, grid.shape, linear, target,
            )  # fmt: skip

        self._each_chunk(work)
        return out

    def transpose(self, values: Floats) -> Floats:
        """(x, y, z, 3) the transpose of :meth:`evaluate` applied to (n, 3) values."""
        from pliant.numerics.lattices import tricubic

        grid = self.grid
        groups = min(8, len(self._starts))  # partial sums that do not depend on the threads, hence reproducible
        sums = np.zeros((groups, *grid.shape, 3))
        flat = source(np.ascontiguousarray(values, np.float64).reshape(-1))

        def work(start: int, stop: int) -> None:
            for group in range(start, stop):
                for k in range(group, len(self._starts), groups):
                    tricubic.gather(
                        k * self._chunk, self._starts[k], self._order, self._local, grid.counts, grid.stride,
                        grid.basis, grid.shape, flat, sums[group].reshape(-1),
                    )  # fmt: skip

        for_chunks(work, groups, 1)
        return np.asarray(sums.sum(axis=0))

    def column(self, selected: tuple[Floats, Floats, Floats]) -> tuple[NDArray[np.int32], Floats]:
        """The points that one control reaches, ascending within each chunk, and its weight at each.

        Parameters
        ----------
        selected
            For each axis (k,) the share, 0 or 1, that the control has in each of the k control values.
        """
        from pliant.numerics.lattices import tricubic

        grid = self.grid
        curves = [self._curves(axis, share) for axis, share in enumerate(selected)]
        chosen = self.cells_of(selected)
        counts = self._starts[:, chosen + 1] - self._starts[:, chosen]
        ends = np.cumsum(counts.sum(axis=1))
        total = int(ends[-1]) if len(ends) else 0
        points, weights = np.empty(total, np.int32), np.empty(total)

        def work(first: int, starts: Integers) -> None:
            k = first // self._chunk
            tricubic.column(
                first, starts, self._order, self._local, grid.counts, *curves, chosen,
                ends[k] - counts[k].sum(), points, weights,
            )  # fmt: skip

        self._each_chunk(work)
        return points, weights

    def cells_of(self, selected: tuple[Floats, Floats, Floats]) -> Integers:
        """The cells in which a control, given by its shares as in :meth:`column`, has a weight."""
        touched = [np.flatnonzero(self._curves(axis, share).any(axis=1)) for axis, share in enumerate(selected)]
        index = np.meshgrid(*touched, indexing="ij")
        return np.ravel_multi_index(tuple(i.reshape(-1) for i in index), tuple(self.grid.counts)).astype(np.int64)

    def points_of(self, chosen: Integers) -> NDArray[np.int32]:
        """The points in some cells."""
        runs = [
            self._order[k * self._chunk + starts[cell] : k * self._chunk + starts[cell + 1]]
            for k, starts in enumerate(self._starts)
            for cell in chosen
            if starts[cell] < starts[cell + 1]
        ]
        return np.concatenate([np.empty(0, np.int32), *runs])

    def basis_values(self) -> tuple[Integers, Floats]:
        """Which control values each point uses and their weights: (n, 64) flat indices and (n, 64) factors.

        Points without a cell have zero weights. Plain NumPy, 1 kB a point: for few points, and as an oracle.
        """
        grid, shape = self.grid, self.grid.shape
        q = np.clip(self.points @ grid.frame[:, :3].T + grid.frame[:, 3], *grid.limits)
        cell = np.clip(np.floor(q), 0, grid.counts - 1).astype(np.int64)
        powers = (q - cell)[..., None] ** np.arange(4)
        x, y, z = np.moveaxis(powers @ grid.basis, 1, 0)
        corner, reach = cell * grid.stride, np.arange(4)
        i, j, k = (corner[:, axis, None] + reach for axis in range(3))
        rows = (i[:, :, None, None] * shape[1] + j[:, None, :, None]) * shape[2] + k[:, None, None, :]
        weights = np.einsum("ni,nj,nk->nijk", x, y, z).reshape(-1, 64)
        weights[self.outside] = 0.0
        return rows.reshape(-1, 64), weights

    def _curves(self, axis: int, share: Floats) -> Floats:
        """(cells, 4) coefficients of a control's basis function in each cell of an axis."""
        starts = np.arange(self.grid.counts[axis]) * self.grid.stride
        return np.ascontiguousarray(share[starts[:, None] + np.arange(4)] @ self.grid.basis.T)

    def _each_chunk(self, work: Callable[[int, Any], None]) -> None:
        for_chunks(lambda start, _stop: work(start, self._starts[start // self._chunk]), len(self.points), self._chunk)


def evaluate_once(grid: CellGrid, points: Floats, lattice: Floats, base: Floats, out: Floats) -> bool:
    """As :meth:`CellPoints.evaluate`, for one use; the points may be what they like.

    Returns
    -------
    bool
        True where all points are finite; False where any is not, or their sums overflow.
    """
    from pliant.numerics.lattices.tricubic_sweep import sweep

    rows, shape = swept(lattice)
    flat, base, target = source(points.reshape(-1)), source(base.reshape(-1)), out.reshape(-1)
    checks = []

    def work(start: int, stop: int) -> None:
        check = sweep(
            flat, start, stop, grid.frame, grid.limits, grid.keep, grid.counts, grid.stride, grid.basis,
            rows, shape, base, target,
        )  # fmt: skip
        checks.append(check)

    for_chunks(work, len(points), min(max(len(points) // 8, 8_192), 131_072))
    return not np.isnan(checks).any()


def swept(lattice: Floats) -> tuple[Floats, Integers]:
    """A lattice (x, y, z, 3) as a sweep takes it, flat, and (3,) its shape there."""
    x, y, z = lattice.shape[:3]
    shape = np.array([x, y, z + z % 2], np.int64)
    twice = _on_cache_lines((2, *shape, 4))
    twice[0, :, :, :z, :3], twice[1, :, :, : z - 1, :3] = lattice, lattice[:, :, 1:]
    return twice.reshape(-1), shape


def _on_cache_lines(shape: tuple[int, ...]) -> Floats:
    """An array of zeros that begins where a cache line of 64 bytes does."""
    size = int(np.prod(shape))
    room = np.zeros(size + 8)
    start = -(room.ctypes.data // 8) % 8
    return room[start : start + size].reshape(shape)


def shift_points(points: NDArray[np.int32], weights: Floats, anchors: Floats, step: Floats, out: Floats) -> None:
    """out[points] = anchors + weights * step, rows of (n, 3)."""
    from pliant.numerics.lattices import tricubic

    flat, base = out.reshape(-1), anchors.reshape(-1)

    def work(start: int, stop: int) -> None:
        tricubic.shift(start, stop, points, weights, base, step, flat)

    for_chunks(work, len(points), 131_072)  # memory sets the pace: a second thread gains on many points only
