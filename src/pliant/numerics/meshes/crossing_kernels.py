"""The kernel that finds triangles that cut one another."""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel

_FLAT = 1e-13  # of a cube: tetrahedra below this are flat, and their corners lie in one plane


@inlined
def _volume(a, b, c, d):
    """Six times the signed volume of a tetrahedron."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    wx, wy, wz = d[0] - a[0], d[1] - a[1], d[2] - a[2]
    return ux * (vy * wz - vz * wy) + uy * (vz * wx - vx * wz) + uz * (vx * wy - vy * wx)


@inlined
def _pierces(p, q, corners):
    """Whether the segment from p to q meets a triangle in whose plane it does not lie."""
    a, b, c = corners[0], corners[1], corners[2]
    above, below = _volume(a, b, c, p), _volume(a, b, c, q)
    size = 0.0
    for i in range(3):
        size = max(size, abs(b[i] - a[i]), abs(c[i] - a[i]), abs(q[i] - p[i]))
    flat = _FLAT * size * size * size
    if above * below > 0.0 or (abs(above) <= flat and abs(below) <= flat):
        return False
    one, two, three = _volume(p, q, a, b), _volume(p, q, b, c), _volume(p, q, c, a)
    return (one >= 0.0 and two >= 0.0 and three >= 0.0) or (one <= 0.0 and two <= 0.0 and three <= 0.0)


@inlined
def edge_through(corners, ids, other, other_ids):
    """Whether an edge of one triangle, none of whose ends the other has, passes through the other."""
    for k in range(3):
        m = (k + 1) % 3
        shared = False
        for n in range(3):
            shared = shared or ids[k] == other_ids[n] or ids[m] == other_ids[n]
        if not shared and _pierces(corners[k], corners[m], other):
            return True
    return False


@kernel
def cutting_pairs(first, one, second, two, low, high, width, itself, found):
    """How many pairs there are; ``found`` gets as many as it holds. ``second`` (b, 3, 3) is sorted by its low x.

    ``one`` and ``two`` are vertex indices: of the same surface where ``itself``.
    """
    count = 0
    nothing = np.full(3, -1)
    for i in range(len(first)):
        corners = first[i]
        x0 = min(corners[0, 0], corners[1, 0], corners[2, 0])
        x1 = max(corners[0, 0], corners[1, 0], corners[2, 0])
        y0 = min(corners[0, 1], corners[1, 1], corners[2, 1])
        y1 = max(corners[0, 1], corners[1, 1], corners[2, 1])
        z0 = min(corners[0, 2], corners[1, 2], corners[2, 2])
        z1 = max(corners[0, 2], corners[1, 2], corners[2, 2])
        for j in range(np.searchsorted(low[:, 0], x0 - width), len(second)):
            if low[j, 0] > x1:
                break
            if high[j, 0] < x0 or low[j, 1] > y1 or high[j, 1] < y0 or low[j, 2] > z1 or high[j, 2] < z0:
                continue
            ids = two[j] if itself else nothing
            if edge_through(corners, one[i], second[j], ids) or edge_through(
                second[j], two[j], corners, one[i] if itself else nothing
            ):
                if count < len(found):
                    found[count, 0], found[count, 1] = i, j
                count += 1
    return count
