"""The kernel for nearest rotations: the largest root of a quartic, and its derivative.

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

from pliant.numerics.compiling import inlined, kernel


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
def _by_quaternion(s, r, horn, vectors):
    """r (9,) = a rotation that maximises tr(R^T S), from the eigenvector of Horn's matrix."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        horn[0, i + 1] = horn[i + 1, 0] = s[3 * k + j] - s[3 * j + k]
        horn[i + 1, i + 1] = s[4 * i] - s[4 * j] - s[4 * k]
        horn[i + 1, j + 1] = horn[j + 1, i + 1] = s[3 * i + j] + s[3 * j + i]
    horn[0, 0] = s[0] + s[4] + s[8]
    best = _largest_by_jacobi(horn, vectors)
    w, x, y, z = vectors[0, best], vectors[1, best], vectors[2, best], vectors[3, best]
    r[0], r[1], r[2] = w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)
    r[3], r[4], r[5] = 2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)
    r[6], r[7], r[8] = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z


@inlined
def nearest_rotation(s, r, horn, vectors):
    """r (9,) = the rotation that maximises tr(R^T S); s (9,) is scaled, (4, 4) ``horn`` and ``vectors`` are scratch."""
    size = 0.0
    for k in range(9):
        size = max(size, abs(s[k]))
    if not size > 1e-280:
        for k in range(9):
            r[k] = 1.0 if k % 4 == 0 else 0.0
        return
    for k in range(9):
        s[k] /= size
    a, b, c, d, e, f, g, h, i = s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8]
    c00, c01, c02 = e * i - f * h, f * g - d * i, d * h - e * g
    c10, c11, c12 = c * h - b * i, a * i - c * g, b * g - a * h
    c20, c21, c22 = b * f - c * e, c * d - a * f, a * e - b * d
    det = a * c00 + b * c01 + c * c02
    aa, bb, cc = a * a + d * d + g * g, b * b + e * e + h * h, c * c + f * f + i * i
    ab, ac, bc = a * b + d * e + g * h, a * c + d * f + g * i, b * c + e * f + h * i
    square = aa + bb + cc
    last = 2.0 * (aa * aa + bb * bb + cc * cc + 2.0 * (ab * ab + ac * ac + bc * bc)) - square * square
    root = math.sqrt(3.0 * square)
    slope = 0.0
    for _ in range(60):
        slope = 4.0 * ((root * root - square) * root - 2.0 * det)
        value = ((root * root - 2.0 * square) * root - 8.0 * det) * root + last
        if slope <= 0.0 or value <= 1e-15 * slope * root:
            break
        root -= value / slope
    if not slope > 4e-4 * root * root * root:
        _by_quaternion(s, r, horn, vectors)
        return
    scale, twice = 4.0 / slope, 2.0 * root
    p = root * root + square
    r[0] = scale * (p * a + twice * c00 - 2.0 * (a * aa + b * ab + c * ac))
    r[1] = scale * (p * b + twice * c01 - 2.0 * (a * ab + b * bb + c * bc))
    r[2] = scale * (p * c + twice * c02 - 2.0 * (a * ac + b * bc + c * cc))
    r[3] = scale * (p * d + twice * c10 - 2.0 * (d * aa + e * ab + f * ac))
    r[4] = scale * (p * e + twice * c11 - 2.0 * (d * ab + e * bb + f * bc))
    r[5] = scale * (p * f + twice * c12 - 2.0 * (d * ac + e * bc + f * cc))
    r[6] = scale * (p * g + twice * c20 - 2.0 * (g * aa + h * ab + i * ac))
    r[7] = scale * (p * h + twice * c21 - 2.0 * (g * ab + h * bb + i * bc))
    r[8] = scale * (p * i + twice * c22 - 2.0 * (g * ac + h * bc + i * cc))
    _orthonormalize(r)


@inlined
def _orthonormalize(r):
    """One Newton-Schulz step, R (3 - R^T R) / 2: squares what is missing to a rotation."""
    a, b, c, d, e, f, g, h, i = r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8]
    aa, bb, cc = (
        1.5 - 0.5 * (a * a + d * d + g * g),
        1.5 - 0.5 * (b * b + e * e + h * h),
        1.5 - 0.5 * (c * c + f * f + i * i),
    )
    ab, ac, bc = -0.5 * (a * b + d * e + g * h), -0.5 * (a * c + d * f + g * i), -0.5 * (b * c + e * f + h * i)
    r[0], r[1], r[2] = a * aa + b * ab + c * ac, a * ab + b * bb + c * bc, a * ac + b * bc + c * cc
    r[3], r[4], r[5] = d * aa + e * ab + f * ac, d * ab + e * bb + f * bc, d * ac + e * bc + f * cc
    r[6], r[7], r[8] = g * aa + h * ab + i * ac, g * ab + h * bb + i * bc, g * ac + h * bc + i * cc


@kernel
def rotate_all(matrices, start, stop, out):
    """out (9 n,) = the nearest rotation of each of the matrices [start, stop) of (9 n,)."""
    s, r, horn, vectors = np.empty(9), np.empty(9), np.empty((4, 4)), np.empty((4, 4))
    for at in range(start, stop):
        for k in range(9):
            s[k] = matrices[9 * at + k]
        nearest_rotation(s, r, horn, vectors)
        for k in range(9):
            out[9 * at + k] = r[k]
