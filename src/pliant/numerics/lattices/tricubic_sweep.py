"""A tricubic sum at points in whatever order they come: nothing is sorted, nothing is kept.

For one use this is faster than sorting: four control values of a row lie side by side, four numbers each, so that
two loads of eight bring a row to the arithmetic of one point. Loads set the pace. The lattice is therefore held
twice, the second time from its second layer along z on, so that four values always begin where a cache line does.
Arguments are those of :mod:`pliant.numerics.lattices.tricubic`, but for the lattice.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel
from pliant.numerics.compute.lanes import (
    affine,
    clamp,
    clear,
    get,
    load,
    load_triples,
    put,
    spread,
    spread_halves,
    store,
    store_sum_of_halves,
    total,
    where_between,
    whole,
)
from pliant.numerics.lattices.tricubic import tabulate


@inlined
def plane(lattice, at, down_y, y0, y1, y2, y3):
    """Half of four rows, summed along y."""
    return (
        load(lattice, at) * y0
        + load(lattice, at + down_y) * y1
        + load(lattice, at + 2 * down_y) * y2
        + load(lattice, at + 3 * down_y) * y3
    )


@inlined
def place(x, y, z, frame, limits, keep, grid, stride, shape, local, corner):
    """Where eight points are: their coordinates in their cells in ``local``, where the cells' values begin.

    Gives 1 in the lanes that belong to a cell, else 0.
    """
    at, odd, inside = spread(0.0), spread(0.0), spread(1.0)
    for axis in range(3):
        value = affine(frame, axis, x, y, z)
        inside = where_between(value, keep[0, axis], keep[1, axis], inside, 0.0)
        value = clamp(value, limits[0, axis], limits[1, axis])
        column = clamp(whole(value), 0.0, grid[axis] - 1.0)
        first_value = column * float(stride)
        odd = first_value - whole(first_value * 0.5) * 2.0  # in the end: along z
        at = at * float(shape[axis]) + first_value
        store(local, 8 * axis, value - column)
    store(corner, 0, (at - odd) * 4.0 + odd * float(4 * shape[0] * shape[1] * shape[2]))
    return inside


@kernel
def sweep(points, first, stop, frame, limits, keep, grid, stride, basis, lattice, shape, base, out):
    """out = base + the tensor product, at points ``first`` to ``stop``; a point without a cell gets its base.

    ``lattice`` is flat, of shape (2, x, y, z, 4) with ``shape`` = (x, y, z) and an even z; the fourth number is not
    used, but finite. Returns 0 where all coordinates are finite, NaN where any is not: the results then mean nothing.
    """
    table, local, corner, moved = np.empty(96), np.empty(24), np.empty(8), np.empty(32)
    here, ground = np.empty(24), np.empty(24)
    clear(here, 0, 24)
    down_x, down_y = shape[1] * shape[2] * 4, shape[2] * 4
    checked = spread(0.0)
    for n in range(first, stop, 8):
        count = 3 * min(8, stop - n)
        if count == 24:
            x, y, z = load_triples(points, 3 * n)
        else:
            for i in range(count):
                put(here, i, get(points, 3 * n + i))
                put(ground, i, get(base, 3 * n + i))
            x, y, z = load_triples(here, 0)
        checked = checked + (x + y + z) * 0.0
        inside = place(x, y, z, frame, limits, keep, grid, stride, shape, local, corner)
        for axis in range(3):
            tabulate(table, 32 * axis, basis, load(local, 8 * axis))
        for b in range(0, 32, 8):
            store(table, b, load(table, b) * inside)
        for lane in range(8):
            p = int(get(corner, lane))
            y0, y1, y2, y3 = get(table, 32 + lane), get(table, 40 + lane), get(table, 48 + lane), get(table, 56 + lane)
            near, far = spread(0.0), spread(0.0)
            for i in range(4):
                weight = get(table, 8 * i + lane)
                near = near + plane(lattice, p + i * down_x, down_y, y0, y1, y2, y3) * weight
                far = far + plane(lattice, p + i * down_x + 8, down_y, y0, y1, y2, y3) * weight
            near = near * spread_halves(get(table, 64 + lane), get(table, 72 + lane))
            far = far * spread_halves(get(table, 80 + lane), get(table, 88 + lane))
            store_sum_of_halves(moved, 3 * lane, near + far)  # the fourth number is overwritten by the next point
        if count == 24:
            for i in range(0, 24, 8):
                store(out, 3 * n + i, load(base, 3 * n + i) + load(moved, i))
        else:
            for i in range(count):
                put(out, 3 * n + i, get(ground, i) + get(moved, i))
    return total(checked)
