"""Kernels of as-rigid-as-possible deformation: how cells turn, and how far their edges are from rigid.

Arguments that the kernels share:

``starts, around, cell_of``
    (c + 1,) where the edges of each cell begin; (k,) the vertex at the far end of each, and that vertex's cell, or -1.
``centers, weights, edges``
    (c,) the vertex of each cell; (k,) edge weights; (3 k,) edges at rest, from the far end to the centre.
``points``
    (3 n,) deformed positions.
``rotations``
    (9 c,) rotations, row by row.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel
from pliant.numerics.compute.lanes import get, put
from pliant.numerics.rigid.polar import nearest_rotations


@inlined
def _misfit(starts, around, weights, edges, points, cell, p, rotations):
    """Σ w |e' - R e|² of one cell, its centre being at 3 p."""
    m, energy = 9 * cell, 0.0
    a, b, c = get(rotations, m), get(rotations, m + 1), get(rotations, m + 2)
    d, e, f = get(rotations, m + 3), get(rotations, m + 4), get(rotations, m + 5)
    g, h, i = get(rotations, m + 6), get(rotations, m + 7), get(rotations, m + 8)
    px, py, pz = get(points, p), get(points, p + 1), get(points, p + 2)
    for k in range(get(starts, cell), get(starts, cell + 1)):
        q = 3 * get(around, k)
        x, y, z = get(edges, 3 * k), get(edges, 3 * k + 1), get(edges, 3 * k + 2)
        u = px - get(points, q) - (a * x + b * y + c * z)
        v = py - get(points, q + 1) - (d * x + e * y + f * z)
        t = pz - get(points, q + 2) - (g * x + h * y + i * z)
        energy += get(weights, k) * (u * u + v * v + t * t)
    return energy


@inlined
def _covariance(starts, around, weights, edges, points, cell, p, s, lane):
    """Σ w e' eᵀ of one cell, its centre being at 3 p, into one lane of s (72,)."""
    px, py, pz = get(points, p), get(points, p + 1), get(points, p + 2)
    a = b = c = d = e = f = g = h = i = 0.0
    for k in range(get(starts, cell), get(starts, cell + 1)):
        q, w = 3 * get(around, k), get(weights, k)
        x, y, z = get(edges, 3 * k), get(edges, 3 * k + 1), get(edges, 3 * k + 2)
        u, v, t = w * (px - get(points, q)), w * (py - get(points, q + 1)), w * (pz - get(points, q + 2))
        a, b, c = a + u * x, b + u * y, c + u * z
        d, e, f = d + v * x, e + v * y, f + v * z
        g, h, i = g + t * x, h + t * y, i + t * z
    for k, entry in enumerate((a, b, c, d, e, f, g, h, i)):
        put(s, 8 * k + lane, entry)


@kernel
def turn(first, stop, starts, around, cell_of, centers, weights, edges, points, bending, rotations):
    """Turn the cells [first, stop) as rigidly as possible; their energy afterwards.

    With ``bending`` > 0 a cell also follows its neighbours' rotations; the cells must then be turned in one piece,
    one after another: so the energy decreases.
    """
    s, r, one, horn, vectors = np.zeros(72), np.empty(72), np.empty(9), np.empty((4, 4)), np.empty((4, 4))
    together = 1 if bending > 0.0 else 8
    energy = 0.0
    for block in range(first, stop, together):
        count = min(together, stop - block)
        for lane in range(count):
            cell = block + lane
            _covariance(starts, around, weights, edges, points, cell, 3 * get(centers, cell), s, lane)
        if bending > 0.0:
            for k in range(get(starts, block), get(starts, block + 1)):
                other, factor = get(cell_of, k), 2.0 * bending * get(weights, k)
                if other >= 0:
                    for m in range(9):
                        put(s, 8 * m, get(s, 8 * m) + factor * get(rotations, 9 * other + m))
        nearest_rotations(s, r, count, one, horn, vectors)
        for lane in range(count):
            for m in range(9):
                put(rotations, 9 * (block + lane) + m, get(r, 8 * m + lane))
        for cell in range(block, block + count):
            energy += _misfit(starts, around, weights, edges, points, cell, 3 * get(centers, cell), rotations)
    return energy


@kernel
def bend(starts, cell_of, weights, rotations):
    """Σ w |R_i - R_j|² over the edges of all cells."""
    energy = 0.0
    for cell in range(len(starts) - 1):
        for k in range(get(starts, cell), get(starts, cell + 1)):
            other = get(cell_of, k)
            if other >= 0:
                for m in range(9):
                    off = get(rotations, 9 * cell + m) - get(rotations, 9 * other + m)
                    energy += get(weights, k) * off * off
    return energy


@kernel
def imbalance(first, stop, starts, around, cell_of, centers, weights, edges, points, rotations, out):
    """out (3 c,) = Σ w ((R_i + R_j) e / 2 - e') of the cells [first, stop): what L x' lacks at their centres.

    All of their neighbours are cells too.
    """
    for cell in range(first, stop):
        p = 3 * get(centers, cell)
        px, py, pz = get(points, p), get(points, p + 1), get(points, p + 2)
        m = 9 * cell
        a, b, c, d, e = (get(rotations, m), get(rotations, m + 1), get(rotations, m + 2), get(rotations, m + 3),
                         get(rotations, m + 4))  # fmt: skip
        f, g, h, i = get(rotations, m + 5), get(rotations, m + 6), get(rotations, m + 7), get(rotations, m + 8)
        u = v = t = 0.0
        for k in range(get(starts, cell), get(starts, cell + 1)):
            q, n, w = 3 * get(around, k), 9 * get(cell_of, k), get(weights, k)
            x, y, z = 0.5 * get(edges, 3 * k), 0.5 * get(edges, 3 * k + 1), 0.5 * get(edges, 3 * k + 2)
            u += w * ((a + get(rotations, n)) * x + (b + get(rotations, n + 1)) * y
                      + (c + get(rotations, n + 2)) * z - (px - get(points, q)))  # fmt: skip
            v += w * ((d + get(rotations, n + 3)) * x + (e + get(rotations, n + 4)) * y
                      + (f + get(rotations, n + 5)) * z - (py - get(points, q + 1)))  # fmt: skip
            t += w * ((g + get(rotations, n + 6)) * x + (h + get(rotations, n + 7)) * y
                      + (i + get(rotations, n + 8)) * z - (pz - get(points, q + 2)))  # fmt: skip
        put(out, 3 * cell, u)
        put(out, 3 * cell + 1, v)
        put(out, 3 * cell + 2, t)
