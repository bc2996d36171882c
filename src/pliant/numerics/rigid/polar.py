"""The kernel for nearest rotations, eight at a time: the largest root of a quartic, and its derivative.

The largest value λ of tr(R^T S) over rotations R is the largest root of

    λ⁴ - 2 |S|² λ² - 8 det(S) λ + 2 |S^T S|² - |S|⁴,

the characteristic polynomial of Horn's matrix (Theobald 2005). Newton's method from above descends to it
monotonously. Since λ is a maximum, its derivative by S is the maximiser R itself: differentiating the polynomial gives
R without an eigenvector. Where the root is double, as for a matrix of rank one, Jacobi's rotations find one of the
maximisers all the same.
"""

from __future__ import annotations

import math

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel
from pliant.numerics.compute.lane_functions import magnitude, where_less
from pliant.numerics.compute.lanes import get, load, put, root, spread, store, total


@inlined
def _largest_by_jacobi(matrix, vectors):
    """Diagonalise a symmetric (4, 4) ``matrix`` in place; which of ``vectors``' columns has the largest eigenvalue."""
    for i in range(4):
        for j in range(4):
            vectors[i, j] = 1.0 if i == j else 0.0
    for _ in range(12):
        for p in range(3):
            for q in range(p + 1, 4):
                off = matrix[p, q]
                if abs(off) > 1e-300:
                    theta = (matrix[q, q] - matrix[p, p]) / (2.0 * off)
                    sign = 1.0 if theta >= 0.0 else -1.0
                    t = sign / (abs(theta) + math.sqrt(theta * theta + 1.0)) if abs(theta) < 1e150 else 0.5 / theta
                    c = 1.0 / math.sqrt(t * t + 1.0)
                    s = t * c
                    for k in range(4):
                        a, b = matrix[k, p], matrix[k, q]
                        matrix[k, p], matrix[k, q] = c * a - s * b, s * a + c * b
                    for k in range(4):
                        a, b = matrix[p, k], matrix[q, k]
                        matrix[p, k], matrix[q, k] = c * a - s * b, s * a + c * b
                        a, b = vectors[k, p], vectors[k, q]
                        vectors[k, p], vectors[k, q] = c * a - s * b, s * a + c * b
    best = 0
    for k in range(1, 4):
        if matrix[k, k] > matrix[best, best]:
            best = k
    return best


@inlined
def _by_quaternion(s, r, lane, horn, vectors):
    """A rotation that maximises tr(R^T S), s (9,), from the eigenvector of Horn's matrix, into one lane of r (72,)."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        horn[0, i + 1] = horn[i + 1, 0] = s[3 * k + j] - s[3 * j + k]
        horn[i + 1, i + 1] = s[4 * i] - s[4 * j] - s[4 * k]
        horn[i + 1, j + 1] = horn[j + 1, i + 1] = s[3 * i + j] + s[3 * j + i]
    horn[0, 0] = s[0] + s[4] + s[8]
    best = _largest_by_jacobi(horn, vectors)
    w, x, y, z = vectors[0, best], vectors[1, best], vectors[2, best], vectors[3, best]
    put(r, lane, w * w + x * x - y * y - z * z)
    put(r, 8 + lane, 2.0 * (x * y - w * z))
    put(r, 16 + lane, 2.0 * (x * z + w * y))
    put(r, 24 + lane, 2.0 * (x * y + w * z))
    put(r, 32 + lane, w * w - x * x + y * y - z * z)
    put(r, 40 + lane, 2.0 * (y * z - w * x))
    put(r, 48 + lane, 2.0 * (x * z - w * y))
    put(r, 56 + lane, 2.0 * (y * z + w * x))
    put(r, 64 + lane, w * w - x * x - y * y + z * z)


@inlined
def nearest_rotations(s, r, count, one, horn, vectors):
    """r (72,) = the rotations that maximise tr(R^T S) for the first ``count`` of eight matrices s (72,).

    Both hold eight of each entry, row by row. ``one`` (9,), (4, 4) ``horn`` and ``vectors`` are scratch; s is scaled.
    """
    zero, unit = spread(0.0), spread(1.0)
    size = zero
    for k in range(9):
        entry = magnitude(load(s, 8 * k))
        size = where_less(size, entry, entry, size)
    scale = unit / where_less(zero + 1e-280, size, size, unit)
    for k in range(9):
        store(s, 8 * k, load(s, 8 * k) * scale)
    a, b, c = load(s, 0), load(s, 8), load(s, 16)
    d, e, f = load(s, 24), load(s, 32), load(s, 40)
    g, h, i = load(s, 48), load(s, 56), load(s, 64)
    c00, c01, c02 = e * i - f * h, f * g - d * i, d * h - e * g
    c10, c11, c12 = c * h - b * i, a * i - c * g, b * g - a * h
    c20, c21, c22 = b * f - c * e, c * d - a * f, a * e - b * d
    det = a * c00 + b * c01 + c * c02
    aa, bb, cc = a * a + d * d + g * g, b * b + e * e + h * h, c * c + f * f + i * i
    ab, ac, bc = a * b + d * e + g * h, a * c + d * f + g * i, b * c + e * f + h * i
    square = aa + bb + cc
    last = 2.0 * (aa * aa + bb * bb + cc * cc + 2.0 * (ab * ab + ac * ac + bc * bc)) - square * square
    top = root(3.0 * square)
    slope = zero
    for _ in range(60):
        slope = 4.0 * ((top * top - square) * top - 2.0 * det)
        value = ((top * top - 2.0 * square) * top - 8.0 * det) * top + last
        going = where_less(1e-15 * slope * top, value, where_less(zero, slope, unit, zero), zero)
        if total(going) == 0.0:
            break
        top = top - going * value / where_less(zero, slope, slope, unit)
    simple = where_less(4e-4 * top * top * top, slope, unit, zero)
    factor, twice = 4.0 * unit / where_less(zero, simple, slope, unit), 2.0 * top
    p = top * top + square
    _orthonormalize(
        r,
        factor * (p * a + twice * c00 - 2.0 * (a * aa + b * ab + c * ac)),
        factor * (p * b + twice * c01 - 2.0 * (a * ab + b * bb + c * bc)),
        factor * (p * c + twice * c02 - 2.0 * (a * ac + b * bc + c * cc)),
        factor * (p * d + twice * c10 - 2.0 * (d * aa + e * ab + f * ac)),
        factor * (p * e + twice * c11 - 2.0 * (d * ab + e * bb + f * bc)),
        factor * (p * f + twice * c12 - 2.0 * (d * ac + e * bc + f * cc)),
        factor * (p * g + twice * c20 - 2.0 * (g * aa + h * ab + i * ac)),
        factor * (p * h + twice * c21 - 2.0 * (g * ab + h * bb + i * bc)),
        factor * (p * i + twice * c22 - 2.0 * (g * ac + h * bc + i * cc)),
    )
    if total(simple) < 8.0:
        store(vectors.reshape(-1), 0, simple)
        doubtful = vectors.reshape(-1)[:8].copy()
        for lane in range(count):
            if doubtful[lane] == 0.0:
                _settle_doubt(s, r, lane, one, horn, vectors)


@inlined
def _settle_doubt(s, r, lane, one, horn, vectors):
    """One of eight rotations where the root is double, or all is zero: that stays as it is."""
    nothing = True
    for k in range(9):
        one[k] = get(s, 8 * k + lane)
        nothing = nothing and abs(one[k]) <= 1e-280
    for k in range(9):
        put(r, 8 * k + lane, 1.0 if k % 4 == 0 else 0.0)
    if not nothing:
        _by_quaternion(one, r, lane, horn, vectors)


@inlined
def _orthonormalize(r, a, b, c, d, e, f, g, h, i):
    """One Newton-Schulz step, R (3 - R^T R) / 2, stored: squares what is missing to a rotation."""
    aa, bb, cc = (
        1.5 - 0.5 * (a * a + d * d + g * g),
        1.5 - 0.5 * (b * b + e * e + h * h),
        1.5 - 0.5 * (c * c + f * f + i * i),
    )
    ab, ac, bc = -0.5 * (a * b + d * e + g * h), -0.5 * (a * c + d * f + g * i), -0.5 * (b * c + e * f + h * i)
    for row, (x, y, z) in enumerate(((a, b, c), (d, e, f), (g, h, i))):
        store(r, 24 * row, x * aa + y * ab + z * ac)
        store(r, 24 * row + 8, x * ab + y * bb + z * bc)
        store(r, 24 * row + 16, x * ac + y * bc + z * cc)


@kernel
def rotate_all(matrices, start, stop, out):
    """out (9 n,) = the nearest rotation of each of the matrices [start, stop) of (9 n,)."""
    s, r, one, horn, vectors = np.zeros(72), np.empty(72), np.empty(9), np.empty((4, 4)), np.empty((4, 4))
    for first in range(start, stop, 8):
        count = min(8, stop - first)
        for lane in range(count):
            for k in range(9):
                put(s, 8 * k + lane, get(matrices, 9 * (first + lane) + k))
        nearest_rotations(s, r, count, one, horn, vectors)
        for lane in range(count):
            for k in range(9):
                put(out, 9 * (first + lane) + k, get(r, 8 * k + lane))
