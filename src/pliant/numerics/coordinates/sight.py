"""A cage as eight points see it: the arms to its vertices, their lengths, and its edges. What its kernels share."""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined
from pliant.numerics.compute.lane_functions import where_less
from pliant.numerics.compute.lanes import get, load, load_triples, put, root, spread, store

TOUCHING = 1e-14  # nearer than this to an edge or a vertex, of the cage's diagonal, is on it


@inlined
def look(points, tail, first, stop, vertices, arms):
    """From eight points to all vertices: arms (24 m,); lanes that are 1 where a vertex is met."""
    for n in range(24):
        put(tail, n, get(points, min(3 * first + n, 3 * stop - 3 + n % 3)))
    x, y, z = load_triples(tail, 0)
    zero = spread(0.0)
    met = zero
    for j in range(len(vertices) // 3):
        ax, ay, az = get(vertices, 3 * j) - x, get(vertices, 3 * j + 1) - y, get(vertices, 3 * j + 2) - z
        store(arms, 24 * j, ax)
        store(arms, 24 * j + 8, ay)
        store(arms, 24 * j + 16, az)
        met = where_less(ax * ax + ay * ay + az * az, zero + TOUCHING * TOUCHING, zero + 1.0, met)
    return met


@inlined
def measure_arms(arms, lengths):
    """The lengths (8 m,) of the arms."""
    for at in range(0, len(lengths), 8):
        x, y, z = load(arms, 3 * at), load(arms, 3 * at + 8), load(arms, 3 * at + 16)
        store(lengths, at, root(x * x + y * y + z * z))


@inlined
def edge_seen(e, edges, lines, arms):
    """Of the arms p and q to an edge's ends: the three parts of p x (q - p), and p . q; then the edge's length."""
    p, q = 24 * edges[e, 0], 24 * edges[e, 1]
    px, py, pz = load(arms, p), load(arms, p + 8), load(arms, p + 16)
    ex, ey, ez = get(lines, 3 * e), get(lines, 3 * e + 1), get(lines, 3 * e + 2)
    cosine = px * load(arms, q) + py * load(arms, q + 8) + pz * load(arms, q + 16)
    return py * ez - pz * ey, pz * ex - px * ez, px * ey - py * ex, cosine, np.sqrt(ex * ex + ey * ey + ez * ez)
