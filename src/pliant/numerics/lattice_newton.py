"""The kernel that inverts x' = A x + t + a tricubic sum: Newton's method, eight points of a cell at a time.

Points wander from cell to cell, so that they are sorted anew before every step: that costs less than it spares.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compiling import inlined, kernel
from pliant.numerics.lanes import get, load, put, root, spread, store
from pliant.numerics.tricubic import _corner, _tabulate, _tabulate_slopes

HALVINGS = 12  # of a step that does not lower the residual

RECORD = 12  # numbers kept of a point, side by side: its image, then
BEST, STEP, LEAST, RATIO, HALVED = 3, 6, 9, 10, 11


@inlined
def _cube_with_slopes(lattice, at, down_x, down_y, table, sums, to):
    """The sum over 4 x 4 x 4 control values and its three slopes, stored at ``sums[to]``: 192 multiply-adds."""
    value, along_x, along_y, along_z = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    for i in range(4):
        plane, plane_y, plane_z = spread(0.0), spread(0.0), spread(0.0)
        for j in range(4):
            row, slope = spread(0.0), spread(0.0)
            for k in range(4):
                control = get(lattice, at + i * down_x + j * down_y + 3 * k)
                row = row + load(table, 128 + 8 * k) * control
                slope = slope + load(table, 160 + 8 * k) * control
            plane = plane + load(table, 64 + 8 * j) * row
            plane_y = plane_y + load(table, 96 + 8 * j) * row
            plane_z = plane_z + load(table, 64 + 8 * j) * slope
        value = value + load(table, 8 * i) * plane
        along_x = along_x + load(table, 32 + 8 * i) * plane
        along_y = along_y + load(table, 8 * i) * plane_y
        along_z = along_z + load(table, 8 * i) * plane_z
    store(sums, to, value)
    store(sums, to + 8, along_x)
    store(sums, to + 16, along_y)
    store(sums, to + 24, along_z)


@inlined
def _row(sums, c, affine, frame):
    """Row c of the Jacobians of eight points, from the slopes in grid coordinates."""
    u, v, w = load(sums, 32 * c + 8), load(sums, 32 * c + 16), load(sums, 32 * c + 24)
    return (
        u * frame[0, 0] + v * frame[1, 0] + w * frame[2, 0] + spread(affine[c, 0]),
        u * frame[0, 1] + v * frame[1, 1] + w * frame[2, 1] + spread(affine[c, 1]),
        u * frame[0, 2] + v * frame[1, 2] + w * frame[2, 2] + spread(affine[c, 2]),
    )


@inlined
def _cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def _equations(here, at, length, sums, affine, frame, found):
    """Newton's equations of eight points by Cramer's rule, stored in ``found``.

    Eight of each: the adjugate times the residual (3), det J, the sum of J's squares, the residual's length, and the
    residual (3).
    """
    x, y, z = load(here, at), load(here, length + at), load(here, 2 * length + at)
    square, size = spread(0.0), spread(0.0)
    for c in range(3):
        image = x * affine[c, 0] + y * affine[c, 1] + z * affine[c, 2] + spread(affine[c, 3])
        residual = load(here, (3 + c) * length + at) - (image + load(sums, 32 * c))
        size = size + residual * residual
        store(found, 48 + 8 * c, residual)
        row = _row(sums, c, affine, frame)
        square = square + row[0] * row[0] + row[1] * row[1] + row[2] * row[2]
    first, second, third = _row(sums, 0, affine, frame), _row(sums, 1, affine, frame), _row(sums, 2, affine, frame)
    a, b, c = _cross(second, third), _cross(third, first), _cross(first, second)
    r0, r1, r2 = load(found, 48), load(found, 56), load(found, 64)
    store(found, 0, a[0] * r0 + b[0] * r1 + c[0] * r2)
    store(found, 8, a[1] * r0 + b[1] * r1 + c[1] * r2)
    store(found, 16, a[2] * r0 + b[2] * r1 + c[2] * r2)
    store(found, 24, first[0] * a[0] + first[1] * a[1] + first[2] * a[2])
    store(found, 32, square)
    store(found, 40, root(size))


@inlined
def _judge(here, at, length, found, lane, state, record):
    """Keep a trial that lowers the residual, with the step from there; go half as far from the best one otherwise."""
    size, whole, square = get(found, 40 + lane), get(found, 24 + lane), get(found, 32 + lane)
    if size < get(state, record + LEAST):
        regular = whole * whole > 1e-28 * square * square * square
        factor = 1.0 / whole if regular else 1.0
        for c in range(3):
            put(state, record + BEST + c, get(here, c * length + at))
            put(state, record + STEP + c, factor * get(found, (0 if regular else 48) + 8 * c + lane))
        put(state, record + LEAST, size)
        put(state, record + RATIO, whole)
        put(state, record + HALVED, 0.0)
    else:
        for c in range(3):
            put(state, record + STEP + c, 0.5 * get(state, record + STEP + c))
        put(state, record + HALVED, get(state, record + HALVED) + 1.0)


@inlined
def _keep_unsolved(count, accepted, active, trial, state):
    """Write the active points that go on, and their next trials, to the front; their number."""
    left = 0
    for place in range(count):
        point = get(active, place)
        record = RECORD * point
        if get(state, record + LEAST) <= accepted or get(state, record + HALVED) > HALVINGS:
            continue
        active[left] = point
        for c in range(3):
            put(trial, 3 * left + c, get(state, record + BEST + c) + get(state, record + STEP + c))
        left += 1
    return left


@kernel
def advance(
    starts, order, local, frame, grid, stride, basis, lattice, shape, affine, accepted, active, trial, state
):  # fmt: skip
    """One step of Newton's method for a chunk's active points; the number of those that are still active.

    Parameters
    ----------
    starts, order, local, frame, grid, stride, basis, lattice, shape
        The trial points, sorted by cell, and the sum: see :mod:`pliant.numerics.tricubic`.
    affine
        (3, 4) A and t.
    accepted
        The residual that counts as solved.
    active, trial
        (k,) numbers of the active points in the chunk, and where to try next, flat; overwritten.
    state
        A record of each point of the chunk, flat: its image (3), the best place so far (3), the step from there (3),
        the residual's length and det J there, and how often the step was halved.
    """
    length, cells, count = len(local) // 3, len(starts) - 2, starts[-1]
    table, sums, here, found = np.empty(192), np.zeros(96), np.empty(6 * length), np.empty(72)
    down_x, down_y = shape[1] * shape[2] * 3, shape[2] * 3
    for at in range(count):  # trial points and images, sorted as the cells' points
        place = get(order, at)
        record = RECORD * get(active, place)
        for c in range(3):
            put(here, c * length + at, get(trial, 3 * place + c))
            put(here, (3 + c) * length + at, get(state, record + c))
    for cell in range(cells + 1):
        if cell == cells:  # where nothing moves but by A and t
            sums[:] = 0.0
        for at in range(starts[cell], starts[cell + 1], 8):
            if cell < cells:
                for axis in range(3):
                    _tabulate(table, 64 * axis, basis, load(local, axis * length + at))
                    _tabulate_slopes(table, 64 * axis + 32, basis, load(local, axis * length + at))
                corner = _corner(cell, grid, stride, shape)
                for c in range(3):
                    _cube_with_slopes(lattice, corner + c, down_x, down_y, table, sums, 32 * c)
            _equations(here, at, length, sums, affine, frame, found)
            for i in range(min(8, starts[cell + 1] - at)):
                _judge(here, at + i, length, found, i, state, RECORD * get(active, get(order, at + i)))
    return _keep_unsolved(count, accepted, active, trial, state)
