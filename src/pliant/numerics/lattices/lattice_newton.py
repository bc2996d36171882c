"""The kernel that inverts x' = A x + t + a tricubic sum: damped Newton's method, eight points side by side.

Points wander from cell to cell, so none are sorted: each step sweeps over them as
:mod:`pliant.numerics.lattices.tricubic_sweep` does. What becomes of a point does not depend on those beside it.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel
from pliant.numerics.compute.lane_functions import where_less
from pliant.numerics.compute.lanes import (
    get,
    load,
    load_triples,
    put,
    root,
    spread,
    spread_halves,
    store,
    store_sum_of_halves,
    total,
)
from pliant.numerics.lattices.tricubic import tabulate, tabulate_slopes
from pliant.numerics.lattices.tricubic_sweep import place, plane

HALVINGS = 12.0  # of a step that does not lower the residual
UPRIGHT = 1e-8  # the least square of det J of which so small a step does not change the sign


@inlined
def _sums(lattice, p, down_x, down_y, table, lane, sums):
    """The sum at one point and its slopes along the three axes of the grid: four triples, 32 numbers apart."""
    y0, y1, y2, y3 = get(table, 64 + lane), get(table, 72 + lane), get(table, 80 + lane), get(table, 88 + lane)
    s0, s1, s2, s3 = get(table, 96 + lane), get(table, 104 + lane), get(table, 112 + lane), get(table, 120 + lane)
    value, along_x, along_y, along_z = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    for half in range(2):
        rows, rows_x, rows_y = spread(0.0), spread(0.0), spread(0.0)
        for i in range(4):
            at = p + i * down_x + 8 * half
            weight, slope = get(table, 8 * i + lane), get(table, 32 + 8 * i + lane)
            summed = plane(lattice, at, down_y, y0, y1, y2, y3)
            rows = rows + summed * weight
            rows_x = rows_x + summed * slope
            rows_y = rows_y + plane(lattice, at, down_y, s0, s1, s2, s3) * weight
        z = 128 + 16 * half + lane
        weights = spread_halves(get(table, z), get(table, z + 8))
        value, along_x, along_y = value + rows * weights, along_x + rows_x * weights, along_y + rows_y * weights
        along_z = along_z + rows * spread_halves(get(table, z + 32), get(table, z + 40))
    store_sum_of_halves(sums, 3 * lane, value)
    store_sum_of_halves(sums, 32 + 3 * lane, along_x)
    store_sum_of_halves(sums, 64 + 3 * lane, along_y)
    store_sum_of_halves(sums, 96 + 3 * lane, along_z)


@inlined
def _moved(lattice, p, down_x, down_y, table, lane, sums):
    """The sum at one point: a triple."""
    y0, y1, y2, y3 = get(table, 64 + lane), get(table, 72 + lane), get(table, 80 + lane), get(table, 88 + lane)
    value = spread(0.0)
    for half in range(2):
        rows = spread(0.0)
        for i in range(4):
            at = p + i * down_x + 8 * half
            rows = rows + plane(lattice, at, down_y, y0, y1, y2, y3) * get(table, 8 * i + lane)
        z = 128 + 16 * half + lane
        value = value + rows * spread_halves(get(table, z), get(table, z + 8))
    store_sum_of_halves(sums, 3 * lane, value)


@inlined
def _column(sums, frame, affine, axis):
    """The derivative of the map along one axis of space."""
    u, v, w = load_triples(sums, 32), load_triples(sums, 64), load_triples(sums, 96)
    f0, f1, f2 = frame[0, axis], frame[1, axis], frame[2, axis]
    return (
        u[0] * f0 + v[0] * f1 + w[0] * f2 + spread(affine[0, axis]),
        u[1] * f0 + v[1] * f1 + w[1] * f2 + spread(affine[1, axis]),
        u[2] * f0 + v[2] * f1 + w[2] * f2 + spread(affine[2, axis]),
    )


@inlined
def _cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def _newton(sums, frame, affine, residual):
    """Newton's step by Cramer's rule, and det J; where J is singular the residual itself."""
    first, second, third = (
        _column(sums, frame, affine, 0),
        _column(sums, frame, affine, 1),
        _column(sums, frame, affine, 2),
    )
    across = _cross(second, third)
    ratio = _dot(first, across)
    square = _dot(first, first) + _dot(second, second) + _dot(third, third)
    singular = 1e-28 * square * square * square
    one, zero = spread(1.0), spread(0.0)
    regular = where_less(singular, ratio * ratio, one, zero)
    factor = one / where_less(zero, regular, ratio, one)
    turned = _cross(residual, third), _cross(second, residual)
    steps = _dot(residual, across), _dot(first, turned[0]), _dot(first, turned[1])
    return (
        where_less(zero, regular, steps[0] * factor, residual[0]),
        where_less(zero, regular, steps[1] * factor, residual[1]),
        where_less(zero, regular, steps[2] * factor, residual[2]),
        ratio,
    )


@inlined
def _residual(image, trial, sums, affine):
    """What the map of the trial lacks of the image."""
    x, y, z = trial
    moved = load_triples(sums, 0)
    return (
        image[0] - (x * affine[0, 0] + y * affine[0, 1] + z * affine[0, 2] + affine[0, 3] + moved[0]),
        image[1] - (x * affine[1, 0] + y * affine[1, 1] + z * affine[1, 2] + affine[1, 3] + moved[1]),
        image[2] - (x * affine[2, 0] + y * affine[2, 1] + z * affine[2, 2] + affine[2, 3] + moved[2]),
    )


@inlined
def _almost(state, close):
    """Whether Newton's next step will solve all eight, and none of them is beside a fold."""
    least, ratio, one, zero = load(state, 48), load(state, 56), spread(1.0), spread(0.0)
    far, folding = where_less(zero + close, least, one, zero), where_less(ratio * ratio, zero + UPRIGHT, one, zero)
    return total(far + folding) == 0.0


@inlined
def _judge(trial, step, size, ratio, state):
    """Keep trials that lower the residual, with the step from there; elsewhere go half as far from the best.

    ``state`` holds eight of each: the best place (3), the step from there (3), the residual's square, det J, halvings.
    """
    least = load(state, 48)
    for c in range(3):
        store(state, 8 * c, where_less(size, least, trial[c], load(state, 8 * c)))
        store(state, 24 + 8 * c, where_less(size, least, step[c], load(state, 24 + 8 * c) * 0.5))
    store(state, 56, where_less(size, least, ratio, load(state, 56)))
    store(state, 64, where_less(size, least, spread(0.0), load(state, 64) + 1.0))
    store(state, 48, where_less(size, least, size, least))


@inlined
def _settled(trial, residual, accepted, state):
    """Whether all trials are solved; then the best of them are kept."""
    size, least, zero = _dot(residual, residual), load(state, 48), spread(0.0)
    if total(where_less(zero + accepted * accepted, size, spread(1.0), zero)) > 0.0:
        return False
    for c in range(3):
        store(state, 8 * c, where_less(size, least, trial[c], load(state, 8 * c)))
    store(state, 48, where_less(size, least, size, least))
    return True


@inlined
def _take(n, count, source, block):
    """Eight points, of which lanes beyond the last do its work again."""
    for i in range(24):
        put(block, i, get(source, 3 * n + min(i, 3 * (count - 1) + i % 3)))


@inlined
def _write(n, count, state, out, error, ratios):
    """What was found of a block of points."""
    store(state, 48, root(load(state, 48)))
    for i in range(count):
        for c in range(3):
            put(out, 3 * (n + i) + c, get(state, 8 * c + i))
        put(error, n + i, get(state, 48 + i))
        put(ratios, n + i, get(state, 56 + i))


@kernel
def invert(
    images, first, stop, start, frame, limits, keep, grid, stride, basis, lattice, shape, affine, accepted, iterations,
    out, error, ratios,
):  # fmt: skip
    """The pre-images of points ``first`` to ``stop``, the lengths of what is left of the residuals, and det J there.

    Where the last step is so small that it does not matter, det J is that before it.

    Parameters
    ----------
    start
        (3 n,) where to begin.
    frame, limits, keep, grid, stride, basis, lattice, shape
        The sum: see :func:`pliant.numerics.lattices.tricubic_sweep.sweep`.
    affine
        (3, 4) A and t.
    accepted
        The residual that counts as solved.
    """
    table, local, corner, sums = np.empty(192), np.empty(24), np.empty(8), np.zeros(128)
    state, block, begin = np.empty(72), np.zeros(24), np.zeros(24)
    down_x, down_y = shape[1] * shape[2] * 4, shape[2] * 4
    zero, close = spread(0.0), accepted / max(abs(frame[0, 0]) + abs(frame[0, 1]) + abs(frame[0, 2]), 1e-300)
    for n in range(first, stop, 8):
        count = min(8, stop - n)
        _take(n, count, images, block)
        _take(n, count, start, begin)
        image, trial = load_triples(block, 0), load_triples(begin, 0)
        state[24:48], state[48:56], state[56:] = 0.0, np.inf, 0.0
        store(state, 0, trial[0])
        store(state, 8, trial[1])
        store(state, 16, trial[2])
        for _ in range(iterations + 1):
            inside = place(trial[0], trial[1], trial[2], frame, limits, keep, grid, stride, shape, local, corner)
            for axis in range(3):
                tabulate(table, 64 * axis, basis, load(local, 8 * axis))
            for b in range(0, 32, 8):
                store(table, b, load(table, b) * inside)
            if _almost(state, close):  # no slopes are needed any more
                for lane in range(8):
                    _moved(lattice, int(get(corner, lane)), down_x, down_y, table, lane, sums)
                if _settled(trial, _residual(image, trial, sums, affine), accepted, state):
                    break
            for axis in range(3):
                tabulate_slopes(table, 64 * axis + 32, basis, load(local, 8 * axis))
            for b in range(32, 64, 8):
                store(table, b, load(table, b) * inside)
            for lane in range(8):
                _sums(lattice, int(get(corner, lane)), down_x, down_y, table, lane, sums)
            residual = _residual(image, trial, sums, affine)
            newton = _newton(sums, frame, affine, residual)
            _judge(trial, (newton[0], newton[1], newton[2]), _dot(residual, residual), newton[3], state)
            going = where_less(zero + accepted * accepted, load(state, 48), spread(1.0), zero)
            going = where_less(zero + HALVINGS, load(state, 64), zero, going)
            if total(going) == 0.0:
                break
            trial = (
                load(state, 0) + load(state, 24) * going,
                load(state, 8) + load(state, 32) * going,
                load(state, 16) + load(state, 40) * going,
            )
        _write(n, count, state, out, error, ratios)
