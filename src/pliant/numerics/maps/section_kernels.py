"""Kernels for maps that carry each section of space by an affine map of its own.

See :mod:`pliant.numerics.maps.sections`. Arguments that the kernels share:

``points, first, stop``
    (3 n,) positions, flat, n >= 8; the kernel works on points ``first`` to ``stop``. The last eight overlap those
    before them, so that lanes are always full.
``frame``
    (3, 4) maps positions to (u, v, s); the rows of its first three columns are orthonormal.
``table, rows``
    The entries that are not zero, sampled at the points, one after another; (9,) where T_ij begins at 3 i + j, or
    -1.
``ramp, pieces``
    (2,) factor and offset from s to the profile's variable t; (k, 6) where a cubic piece begins and ends, and its
    coefficients from its beginning on, the lowest power first.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel
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
from pliant.numerics.compute.sincos import sincos


@inlined
def _turned(frame, axis, du, dv, ds):
    """One coordinate in the world of a local vector."""
    return du * frame[0, axis] + dv * frame[1, axis] + ds * frame[2, axis]


@kernel
def measure(points, first, stop, frame, radial, q):
    """q (stop - first,) = the section that each point is in: s, or r where ``radial``."""
    for block in range(first, stop, 8):
        at = min(block, stop - 8)
        x, y, z = load_triples(points, 3 * at)
        if radial:
            u, v = affine(frame, 0, x, y, z), affine(frame, 1, x, y, z)
            store(q, at - first, root(u * u + v * v))
        else:
            store(q, at - first, affine(frame, 2, x, y, z))


@inlined
def _entry(table, row, at):
    return load(table, row + at) if row >= 0 else spread(0.0)


@inlined
def _component(table, rows, i, at, u, v):
    return (
        _entry(table, rows[3 * i], at) + _entry(table, rows[3 * i + 1], at) * u + _entry(table, rows[3 * i + 2], at) * v
    )


@kernel
def displace(points, first, stop, frame, table, rows, base, out):
    """out (3 n,) = base + the displacement, turned into the world; gives zero if all of it is finite, else NaN."""
    doubt = spread(0.0)
    for block in range(first, stop, 8):
        at = min(block, stop - 8)
        x, y, z = load_triples(points, 3 * at)
        u, v = affine(frame, 0, x, y, z), affine(frame, 1, x, y, z)
        du = _component(table, rows, 0, at - first, u, v)
        dv = _component(table, rows, 1, at - first, u, v)
        ds = _component(table, rows, 2, at - first, u, v)
        x, y, z = load_triples(base, 3 * at)
        x, y, z = (
            x + _turned(frame, 0, du, dv, ds),
            y + _turned(frame, 1, du, dv, ds),
            z + _turned(frame, 2, du, dv, ds),
        )
        store_triples(out, 3 * at, x, y, z)
        doubt = doubt + (x * 0.0 + y * 0.0 + z * 0.0)
    return total(doubt)


@inlined
def _write_jacobians(local, scratch, frame, at, out):
    """Eight Jacobians from the local derivative of the displacement, row by row in ``local``."""
    for i in range(3):
        du, dv, ds = load(local, 24 * i), load(local, 24 * i + 8), load(local, 24 * i + 16)
        for axis in range(3):
            store(local, 8 * (3 * i + axis), _turned(frame, axis, du, dv, ds))
    for axis in range(3):
        du, dv, ds = load(local, 8 * axis), load(local, 24 + 8 * axis), load(local, 48 + 8 * axis)
        for c in range(3):
            identity = 1.0 if c == axis else 0.0
            store(scratch, 8 * (3 * c + axis), _turned(frame, c, du, dv, ds) + identity)
    for i in range(8):
        for n in range(9):
            put(out, 9 * (at + i) + n, get(scratch, 8 * n + i))


@kernel
def differentiate(points, first, stop, frame, table, rows, slopes, slope_rows, q, radial, out):
    """out (9 n,) = the Jacobians of x + displacement; ``slopes`` holds the derivatives of the entries by q."""
    local, scratch = np.empty(72), np.empty(72)
    for block in range(first, stop, 8):
        at = min(block, stop - 8)
        x, y, z = load_triples(points, 3 * at)
        u, v = affine(frame, 0, x, y, z), affine(frame, 1, x, y, z)
        for i in range(3):
            steep = _component(slopes, slope_rows, i, at - first, u, v)
            by_u = _entry(table, rows[3 * i + 1], at - first)
            by_v = _entry(table, rows[3 * i + 2], at - first)
            if radial:  # the gradient of r is (u, v) / r; on the axis itself it is taken as zero
                r = load(q, at - first)
                steep = steep / where_between(r, 0.0, 0.0, spread(1.0), r)
                by_u, by_v, steep = by_u + steep * u, by_v + steep * v, spread(0.0)
            store(local, 24 * i, by_u)
            store(local, 24 * i + 8, by_v)
            store(local, 24 * i + 16, steep)
        _write_jacobians(local, scratch, frame, at, out)


@inlined
def _profile(s, ramp, pieces):
    """A profile's value and its slope by t; constant beyond its ends."""
    t = s * ramp[0] + ramp[1]
    ends = clamp(t, pieces[0, 0], pieces[-1, 1])
    value, slope = spread(0.0), spread(0.0)
    for k in range(len(pieces)):
        low, high = pieces[k, 0], pieces[k, 1]
        x = ends - low
        here = ((x * pieces[k, 5] + pieces[k, 4]) * x + pieces[k, 3]) * x + pieces[k, 2]
        steep = (x * (3.0 * pieces[k, 5]) + 2.0 * pieces[k, 4]) * x + pieces[k, 3]
        value = where_between(ends, low, high, here, value)
        slope = where_between(t, low, high, steep, slope)
    return value, slope


@kernel
def similar(points, first, stop, frame, ramp, pieces, angle, growth, out):
    """out (3 n,) = sections turned by angle h and scaled by 1 + growth h, for a profile h(t).

    Gives zero if all of it is finite, else NaN.
    """
    doubt = spread(0.0)
    for block in range(first, stop, 8):
        at = min(block, stop - 8)
        x, y, z = load_triples(points, 3 * at)
        u, v = affine(frame, 0, x, y, z), affine(frame, 1, x, y, z)
        h, _ = _profile(affine(frame, 2, x, y, z), ramp, pieces)
        scale = h * growth + 1.0
        sine, cosine = spread(0.0), scale
        if angle != 0.0:
            sine, cosine = sincos(h * angle)
            sine, cosine = sine * scale, cosine * scale
        du, dv, ds = (cosine - 1.0) * u - sine * v, sine * u + (cosine - 1.0) * v, spread(0.0)
        x, y, z = (
            x + _turned(frame, 0, du, dv, ds),
            y + _turned(frame, 1, du, dv, ds),
            z + _turned(frame, 2, du, dv, ds),
        )
        store_triples(out, 3 * at, x, y, z)
        doubt = doubt + (x * 0.0 + y * 0.0 + z * 0.0)
    return total(doubt)


@kernel
def similar_slopes(points, first, stop, frame, ramp, pieces, angle, growth, out):
    """out (9 n,) = the Jacobians of :func:`similar`."""
    local, scratch = np.empty(72), np.empty(72)
    for block in range(first, stop, 8):
        at = min(block, stop - 8)
        x, y, z = load_triples(points, 3 * at)
        u, v = affine(frame, 0, x, y, z), affine(frame, 1, x, y, z)
        h, slope = _profile(affine(frame, 2, x, y, z), ramp, pieces)
        slope = slope * ramp[0]
        scale, grows, turns = h * growth + 1.0, slope * growth, slope * angle
        sine, cosine = spread(0.0), spread(1.0)
        if angle != 0.0:
            sine, cosine = sincos(h * angle)
        by_s_along, by_s_across = grows * cosine - scale * sine * turns, grows * sine + scale * cosine * turns
        store(local, 0, scale * cosine - 1.0)
        store(local, 8, spread(0.0) - scale * sine)
        store(local, 16, by_s_along * u - by_s_across * v)
        store(local, 24, scale * sine)
        store(local, 32, scale * cosine - 1.0)
        store(local, 40, by_s_across * u + by_s_along * v)
        for n in range(48, 72, 8):
            store(local, n, spread(0.0))
        _write_jacobians(local, scratch, frame, at, out)
