"""Kernels for sums of radial functions around centres, eight points at a time.

Arguments that the kernels share:

``points, first, stop``
    (3 n,) positions, flat, n >= 8; the kernel works on points ``first`` to ``stop``. The last eight overlap those
    before them, so that lanes are always full.
``centers, scale, support``
    (3 k,) centres, flat; radii are multiplied with ``scale``; the function is phi(r) = -r where ``support`` is not
    set, else Wendland's (1 - r)^4 (4 r + 1) for r < 1.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel
from pliant.numerics.compute.lane_functions import quick_root
from pliant.numerics.compute.lanes import (
    affine,
    clamp,
    get,
    load,
    load_triples,
    put,
    root,
    spread,
    store,
    store_triples,
    total,
    where_between,
)


@inlined
def _from(centers, k, x, y, z):
    return x - get(centers, 3 * k), y - get(centers, 3 * k + 1), z - get(centers, 3 * k + 2)


@inlined
def _phi(square, scale, support):
    r = quick_root(square) * scale
    if support:
        less = clamp(1.0 - r, 0.0, 1.0)
        less = less * less
        return less * less * (4.0 * r + 1.0)
    return spread(0.0) - r


@inlined
def _slope_over_radius(square, scale, support):
    """The derivative of phi by r over r, times scale squared; zero at the tip of -r."""
    r = root(square) * scale
    if support:
        less = clamp(1.0 - r, 0.0, 1.0)
        return less * less * less * (-20.0 * scale * scale)
    inverse = spread(-scale * scale) / where_between(r, 0.0, 0.0, spread(1.0), r)
    return where_between(r, 0.0, 0.0, spread(0.0), inverse)


@kernel
def radial_sum(points, first, stop, centers, scale, support, values, linear, base, out):
    """out (3 n,) = base + linear (3, 4) at the points + the sum over the centres of phi times (3 k,) values."""
    for block in range(first, stop, 8):
        at = min(block, stop - 8)
        x, y, z = load_triples(points, 3 * at)
        a, b, c = affine(linear, 0, x, y, z), affine(linear, 1, x, y, z), affine(linear, 2, x, y, z)
        for k in range(len(centers) // 3):
            dx, dy, dz = _from(centers, k, x, y, z)
            phi = _phi(dx * dx + dy * dy + dz * dz, scale, support)
            a, b, c = a + phi * get(values, 3 * k), b + phi * get(values, 3 * k + 1), c + phi * get(values, 3 * k + 2)
        u, v, w = load_triples(base, 3 * at)
        store_triples(out, 3 * at, u + a, v + b, w + c)


@kernel
def radial_slopes(points, first, stop, centers, scale, support, values, linear, out):
    """out (9 n,) = linear (3, 3) + the derivative of the sum by position."""
    sums = np.empty(72)
    for block in range(first, stop, 8):
        at = min(block, stop - 8)
        x, y, z = load_triples(points, 3 * at)
        for n in range(9):
            store(sums, 8 * n, spread(linear[n // 3, n % 3]))
        for k in range(len(centers) // 3):
            dx, dy, dz = _from(centers, k, x, y, z)
            slope = _slope_over_radius(dx * dx + dy * dy + dz * dz, scale, support)
            dx, dy, dz = dx * slope, dy * slope, dz * slope
            for c in range(3):
                value = get(values, 3 * k + c)
                store(sums, 24 * c, load(sums, 24 * c) + dx * value)
                store(sums, 24 * c + 8, load(sums, 24 * c + 8) + dy * value)
                store(sums, 24 * c + 16, load(sums, 24 * c + 16) + dz * value)
        for i in range(8):
            for n in range(9):
                put(out, 9 * (at + i) + n, get(sums, 8 * n + i))


@kernel
def radial_gather(points, first, stop, centers, scale, support, values, sums):
    """sums (3 k,) = the transpose of :func:`radial_sum`: each centre's sum over the points of phi times values.

    Here ``stop - first`` is a multiple of eight.
    """
    partial = np.zeros(24 * (len(centers) // 3))
    for at in range(first, stop, 8):
        x, y, z = load_triples(points, 3 * at)
        u, v, w = load_triples(values, 3 * at)
        for k in range(len(centers) // 3):
            dx, dy, dz = _from(centers, k, x, y, z)
            phi = _phi(dx * dx + dy * dy + dz * dz, scale, support)
            store(partial, 24 * k, load(partial, 24 * k) + phi * u)
            store(partial, 24 * k + 8, load(partial, 24 * k + 8) + phi * v)
            store(partial, 24 * k + 16, load(partial, 24 * k + 16) + phi * w)
    for n in range(len(centers)):
        sums[n] = total(load(partial, 8 * n))
