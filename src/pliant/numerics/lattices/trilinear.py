"""Kernels for trilinear interpolation on a grid of nodes.

Arguments that the kernels share:

``points, start, stop``
    Positions, flat (n * 3,), and the piece to work on.
``frame, keep``
    (3, 4) maps positions to grid coordinates, in which node i of an axis lies at i; (2, 3) grid coordinates beyond
    which a point gets nothing. Between the outermost nodes and ``keep`` the outermost values go on.
``lattice, shape``
    Node values, flat, of shape (x, y, z, 3), and (x, y, z), each at least 2.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel


@inlined
def _coordinate(points, n, frame, axis):
    """A point's coordinate on the grid along one axis."""
    x, y, z = points[3 * n], points[3 * n + 1], points[3 * n + 2]
    return x * frame[axis, 0] + y * frame[axis, 1] + z * frame[axis, 2] + frame[axis, 3]


@inlined
def _place(points, n, frame, keep, shape, cell, local):
    """The cell of a point and where it is in there; False beyond ``keep``."""
    inside = True
    for axis in range(3):
        q = _coordinate(points, n, frame, axis)
        inside = inside and keep[0, axis] <= q <= keep[1, axis]
        q = min(max(q, 0.0), shape[axis] - 1.0)
        cell[axis] = min(int(q), shape[axis] - 2)
        local[axis] = q - cell[axis]
    return inside


@kernel
def evaluate(points, start, stop, frame, keep, lattice, shape, base, out):
    """out = base + the interpolated value."""
    cell, local = np.empty(3, np.int64), np.empty(3)
    down_x, down_y = 3 * shape[1] * shape[2], 3 * shape[2]
    for n in range(start, stop):
        inside = _place(points, n, frame, keep, shape, cell, local)
        corner = down_x * cell[0] + down_y * cell[1] + 3 * cell[2]
        x, y, z = local[0], local[1], local[2]
        for c in range(3):
            value = 0.0
            if inside:
                at = corner + c
                near = (1 - y) * ((1 - z) * lattice[at] + z * lattice[at + 3]) + y * (
                    (1 - z) * lattice[at + down_y] + z * lattice[at + down_y + 3]
                )
                at += down_x
                far = (1 - y) * ((1 - z) * lattice[at] + z * lattice[at + 3]) + y * (
                    (1 - z) * lattice[at + down_y] + z * lattice[at + down_y + 3]
                )
                value = (1 - x) * near + x * far
            out[3 * n + c] = base[3 * n + c] + value


@kernel
def differentiate(points, start, stop, frame, keep, lattice, shape, out):
    """Add the derivative of the interpolated value with respect to position to (n, 3, 3); 0 where values go on."""
    cell, local = np.empty(3, np.int64), np.empty(3)
    share, slope, gradient = np.empty((3, 2)), np.empty((3, 2)), np.empty(3)
    for n in range(start, stop):
        if not _place(points, n, frame, keep, shape, cell, local):
            continue
        for axis in range(3):
            q = _coordinate(points, n, frame, axis)
            inside = 1.0 if 0.0 <= q <= shape[axis] - 1.0 else 0.0
            share[axis, 0], share[axis, 1] = 1.0 - local[axis], local[axis]
            slope[axis, 0], slope[axis, 1] = -inside, inside
        for c in range(3):
            gradient[:] = 0.0
            for i in range(2):
                for j in range(2):
                    for k in range(2):
                        node = ((cell[0] + i) * shape[1] + cell[1] + j) * shape[2] + cell[2] + k
                        value = lattice[3 * node + c]
                        gradient[0] += slope[0, i] * share[1, j] * share[2, k] * value
                        gradient[1] += share[0, i] * slope[1, j] * share[2, k] * value
                        gradient[2] += share[0, i] * share[1, j] * slope[2, k] * value
            for axis in range(3):
                for a in range(3):
                    out[9 * n + 3 * c + a] += gradient[axis] * frame[axis, a]


@kernel
def basis(points, start, stop, frame, keep, shape, columns, weights):
    """The eight nodes that each point uses, flat, and their weights: rows of (n, 8)."""
    cell, local = np.empty(3, np.int64), np.empty(3)
    for n in range(start, stop):
        inside = _place(points, n, frame, keep, shape, cell, local)
        at = 8 * n
        for i in range(2):
            for j in range(2):
                for k in range(2):
                    columns[at] = ((cell[0] + i) * shape[1] + cell[1] + j) * shape[2] + cell[2] + k
                    weight = abs(1 - i - local[0]) * abs(1 - j - local[1]) * abs(1 - k - local[2])
                    weights[at] = weight if inside else 0.0
                    at += 1
