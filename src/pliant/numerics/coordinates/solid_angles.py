"""The kernel for solid angles, eight points at a time."""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import kernel
from pliant.numerics.compute.lane_functions import angle, magnitude, with_sign
from pliant.numerics.compute.lanes import get, load, put, spread, store
from pliant.numerics.coordinates.sight import look, measure_arms


@kernel
def solid_angles(points, first, stop, vertices, triangles, out):
    """Out (n,) the sum of the signed solid angles of triangles (t, 3), seen from flat points."""
    count = len(vertices) // 3
    tail, arms, lengths, piece = np.empty(24), np.empty(24 * count), np.empty(8 * count), np.empty(8)
    for n in range(first, stop, 8):
        look(points, tail, n, stop, vertices, arms)
        measure_arms(arms, lengths)
        total = spread(0.0)
        for t in range(len(triangles)):
            a, b, c = 24 * triangles[t, 0], 24 * triangles[t, 1], 24 * triangles[t, 2]
            ax, ay, az = load(arms, a), load(arms, a + 8), load(arms, a + 16)
            bx, by, bz = load(arms, b), load(arms, b + 8), load(arms, b + 16)
            cx, cy, cz = load(arms, c), load(arms, c + 8), load(arms, c + 16)
            ra, rb, rc = load(lengths, a // 3), load(lengths, b // 3), load(lengths, c // 3)
            det = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
            side = ra * rb * rc + (ax * bx + ay * by + az * bz) * rc
            side = side + (bx * cx + by * cy + bz * cz) * ra + (cx * ax + cy * ay + cz * az) * rb
            total = total + with_sign(2.0 * angle(magnitude(det), side, spread(0.0)), det)
        store(piece, 0, total)
        for lane in range(min(8, stop - n)):
            put(out, n + lane, get(piece, lane))
