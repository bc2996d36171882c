"""The kernel for trivariate Bernstein polynomials of any degree: sixteen points at a time."""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel
from pliant.numerics.compute.lanes import (
    affine,
    clear,
    get,
    load,
    load_triples,
    put,
    spread,
    store,
    store_triples,
    where_between,
)


@inlined
def _fill(table, at, binomials, t, keep, axis, inside):
    """Bernstein polynomials of eight parameters, basis function i at ``table[at + 16 * i]``.

    Gives ``inside`` in the lanes that are within the bounds of the axis, 0 in the others.
    """
    degree = len(binomials) - 1
    power = spread(1.0)
    for i in range(degree + 1):
        store(table, at + 16 * i, power * binomials[i])
        power = power * t
    power = spread(1.0)
    for i in range(degree, -1, -1):
        store(table, at + 16 * i, load(table, at + 16 * i) * power)
        power = power * (1.0 - t)
    return where_between(t, keep[0, axis], keep[1, axis], inside, 0.0)


@kernel
def evaluate(points, start, stop, frame, keep, across, down, along, lattice, base, out):
    """out = base + the Bernstein sum at points [start, stop); points beyond ``keep`` (2, 3) get their base.

    ``frame`` (3, 4) maps positions to parameters; ``across``, ``down`` and ``along`` are the binomial coefficients
    of the three degrees; ``lattice`` the control values, flat, of shape (l + 1, m + 1, n + 1, 3).
    """
    xs, ys, zs = np.empty(16 * len(across)), np.empty(16 * len(down)), np.empty(16 * len(along))
    block, moved, inside = np.empty(48), np.empty(48), np.empty(16)
    clear(block, 0, 48)
    for first in range(start, stop, 16):
        count = min(16, stop - first)
        for n in range(3 * count):
            put(block, n, get(points, 3 * first + n))
        for half in range(2):
            x, y, z = load_triples(block, 24 * half)
            within = _fill(xs, 8 * half, across, affine(frame, 0, x, y, z), keep, 0, spread(1.0))
            within = _fill(ys, 8 * half, down, affine(frame, 1, x, y, z), keep, 1, within)
            store(inside, 8 * half, _fill(zs, 8 * half, along, affine(frame, 2, x, y, z), keep, 2, within))
        x0, y0, z0, x1, y1, z1 = spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0)
        at = 0
        for i in range(len(across)):
            for j in range(len(down)):
                a0, b0, c0, a1, b1, c1 = spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0)
                for k in range(len(along)):
                    w0, w1 = load(zs, 16 * k), load(zs, 16 * k + 8)
                    a, b, c = get(lattice, at), get(lattice, at + 1), get(lattice, at + 2)
                    a0, b0, c0 = a0 + w0 * a, b0 + w0 * b, c0 + w0 * c
                    a1, b1, c1 = a1 + w1 * a, b1 + w1 * b, c1 + w1 * c
                    at += 3
                w0, w1 = load(xs, 16 * i) * load(ys, 16 * j), load(xs, 16 * i + 8) * load(ys, 16 * j + 8)
                x0, y0, z0 = x0 + w0 * a0, y0 + w0 * b0, z0 + w0 * c0
                x1, y1, z1 = x1 + w1 * a1, y1 + w1 * b1, z1 + w1 * c1
        w0, w1 = load(inside, 0), load(inside, 8)
        store_triples(moved, 0, x0 * w0, y0 * w0, z0 * w0)
        store_triples(moved, 24, x1 * w1, y1 * w1, z1 * w1)
        for n in range(3 * count):
            put(out, 3 * first + n, get(base, 3 * first + n) + get(moved, n))
