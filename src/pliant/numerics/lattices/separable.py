"""Tricubic sums on a regular grid along the lattice's own axes: three matrix products in place of a sum a point."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.lattices.cells import CellGrid

Floats = NDArray[np.float64]


def axis_basis(grid: CellGrid, axis: int, q: Floats) -> Floats:
    """(k, values) the basis functions of one axis at (k,) grid coordinates; zero beyond ``keep``."""
    inside = np.clip(q, grid.limits[0, axis], grid.limits[1, axis])
    cell = np.clip(np.floor(inside), 0, grid.counts[axis] - 1).astype(np.int64)
    weights = (inside - cell)[:, None] ** np.arange(4) @ grid.basis
    weights[(q < grid.keep[0, axis]) | (q > grid.keep[1, axis])] = 0.0
    rows = np.zeros((len(q), int(grid.shape[axis])))
    np.put_along_axis(rows, cell[:, None] * grid.stride + np.arange(4), weights, axis=1)
    return rows


def grid_sum(grid: CellGrid, lattice: Floats, coordinates: tuple[Floats, Floats, Floats]) -> Floats:
    """(kx, ky, kz, 3) the tensor product at the grid that three lists of grid coordinates span."""
    x, y, z = (axis_basis(grid, axis, q) for axis, q in enumerate(coordinates))
    along = np.matmul(z, lattice)  # (x, y, kz, 3): the small products first
    plane = np.matmul(y, along.reshape(*along.shape[:2], -1))
    out = np.empty((len(x), len(y), len(z), 3))
    np.matmul(x, plane.reshape(len(plane), -1), out=out.reshape(len(x), -1))
    return out
