"""The kernel that inverts x' = A x + t + a tricubic sum: Newton's method, a point at a time.

Points wander from cell to cell, so that they are not sorted: it is the 64 control values of one point that go
through the arithmetic together. Each takes four places (x, y, z, 0), and a row of four along z is two vectors.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compiling import inlined, kernel
from pliant.numerics.lanes import get, load, put, spread, store

_HALVINGS = 12  # of a step that does not lower the residual


@inlined
def _weights(basis, t, values, slopes):
    for b in range(4):
        values[b] = ((t * basis[3, b] + basis[2, b]) * t + basis[1, b]) * t + basis[0, b]
        slopes[b] = (t * (3.0 * basis[3, b]) + 2.0 * basis[2, b]) * t + basis[1, b]


@inlined
def _column(lattice, at, down, w, half):
    """The sum along x, for half a row along z."""
    at = at + 8 * half
    return (
        load(lattice, at) * w[0]
        + load(lattice, at + down) * w[1]
        + load(lattice, at + 2 * down) * w[2]
        + load(lattice, at + 3 * down) * w[3]
    )


@inlined
def _evaluate(x, frame, limits, keep, grid, stride, basis, lattice, shape, affine, weights, rows, image, jacobian):
    """The image (3,) and the Jacobian (3, 3) at a point (3,)."""
    for c in range(3):
        image[c] = affine[c, 0] * x[0] + affine[c, 1] * x[1] + affine[c, 2] * x[2] + affine[c, 3]
        for a in range(3):
            jacobian[c, a] = affine[c, a]
    at = 0
    for axis in range(3):
        q = frame[axis, 0] * x[0] + frame[axis, 1] * x[1] + frame[axis, 2] * x[2] + frame[axis, 3]
        if not keep[0, axis] <= q <= keep[1, axis]:
            return
        q = min(max(q, limits[0, axis]), limits[1, axis])
        cell = min(max(np.floor(q), 0.0), grid[axis] - 1.0)
        _weights(basis, q - cell, weights[axis, 0], weights[axis, 1])
        at = at * shape[axis] + stride * int(cell)
    down_x, down_y = 4 * shape[1] * shape[2], 4 * shape[2]
    wx, sx, wy, sy, wz, sz = weights[0, 0], weights[0, 1], weights[1, 0], weights[1, 1], weights[2, 0], weights[2, 1]
    for half in range(2):
        value, along_x, along_y = spread(0.0), spread(0.0), spread(0.0)
        for j in range(4):
            column = _column(lattice, 4 * at + j * down_y, down_x, wx, half)
            slope = _column(lattice, 4 * at + j * down_y, down_x, sx, half)
            value = value + column * wy[j]
            along_x = along_x + slope * wy[j]
            along_y = along_y + column * sy[j]
        store(rows, 8 * half, value)
        store(rows, 16 + 8 * half, along_x)
        store(rows, 32 + 8 * half, along_y)
    for c in range(3):
        moved, u, v, w = 0.0, 0.0, 0.0, 0.0
        for k in range(4):
            moved += wz[k] * get(rows, 4 * k + c)
            u += wz[k] * get(rows, 16 + 4 * k + c)
            v += wz[k] * get(rows, 32 + 4 * k + c)
            w += sz[k] * get(rows, 4 * k + c)
        image[c] += moved
        for a in range(3):
            jacobian[c, a] += u * frame[0, a] + v * frame[1, a] + w * frame[2, a]


@inlined
def _newton_step(m, residual, step):
    """Solve m step = residual by Cramer's rule; a singular matrix gives the residual itself. The determinant."""
    c00 = m[1, 1] * m[2, 2] - m[1, 2] * m[2, 1]
    c01 = m[1, 2] * m[2, 0] - m[1, 0] * m[2, 2]
    c02 = m[1, 0] * m[2, 1] - m[1, 1] * m[2, 0]
    whole = m[0, 0] * c00 + m[0, 1] * c01 + m[0, 2] * c02
    size = 0.0
    for c in range(3):
        size += m[c, 0] * m[c, 0] + m[c, 1] * m[c, 1] + m[c, 2] * m[c, 2]
    if abs(whole) <= 1e-14 * size * np.sqrt(size):
        for c in range(3):
            step[c] = residual[c]
        return whole
    a, b, c = residual[0], residual[1], residual[2]
    step[0] = (
        a * c00 + b * (m[0, 2] * m[2, 1] - m[0, 1] * m[2, 2]) + c * (m[0, 1] * m[1, 2] - m[0, 2] * m[1, 1])
    ) / whole
    step[1] = (
        a * c01 + b * (m[0, 0] * m[2, 2] - m[0, 2] * m[2, 0]) + c * (m[0, 2] * m[1, 0] - m[0, 0] * m[1, 2])
    ) / whole
    step[2] = (
        a * c02 + b * (m[0, 1] * m[2, 0] - m[0, 0] * m[2, 1]) + c * (m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0])
    ) / whole
    return whole


@kernel
def solve(
    start, stop, images, frame, limits, keep, grid, stride, basis, lattice, shape, affine, back, accepted, iterations,
    out, error, ratio,
):  # fmt: skip
    """Pre-images of images [start, stop), flat; the length of each residual, and det J at each pre-image.

    ``lattice`` holds four places a control value, flat, and ends with room for one vector; ``affine`` (3, 4) is A and
    t, ``back`` (3, 4) its inverse; the other arguments are those of :mod:`pliant.numerics.tricubic`.
    """
    weights, rows = np.empty((3, 2, 4)), np.empty(48)
    x, best, step = np.empty(3), np.empty(3), np.empty(3)
    image, residual, jacobian = np.empty(3), np.empty(3), np.empty((3, 3))
    for n in range(start, stop):
        for c in range(3):
            y0, y1, y2 = get(images, 3 * n), get(images, 3 * n + 1), get(images, 3 * n + 2)
            x[c] = back[c, 0] * y0 + back[c, 1] * y1 + back[c, 2] * y2 + back[c, 3]
            step[c] = 0.0
        least, found, halvings, taken = np.inf, 1.0, 0, 0
        while True:
            _evaluate(
                x, frame, limits, keep, grid, stride, basis, lattice, shape, affine, weights, rows, image, jacobian
            )
            size = 0.0
            for c in range(3):
                residual[c] = get(images, 3 * n + c) - image[c]
                size += residual[c] * residual[c]
            size = np.sqrt(size)
            if size < least:
                least, halvings = size, 0
                for c in range(3):
                    best[c] = x[c]
                found = _newton_step(jacobian, residual, step)
                taken += 1
            else:
                halvings += 1
                for c in range(3):
                    step[c] *= 0.5
            if least <= accepted or taken > iterations or halvings > _HALVINGS:
                break
            for c in range(3):
                x[c] = best[c] + step[c]
        for c in range(3):
            put(out, 3 * n + c, best[c])
        error[n] = least
        ratio[n] = found
