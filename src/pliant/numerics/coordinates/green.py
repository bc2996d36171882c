"""Kernels for Green coordinates of triangle cages (Lipman, Levin & Cohen-Or 2008).

With a_i from the point to the corners of a triangle, edges e_i from corner i to the next, of length l_i, the outward
unit normal n, the area A, m_i = e_i x n / l_i and h_i = m_i . a_i, d = n . a_0:

    L_i = ln((r_i + r_(i+1) + l_i) / (r_i + r_(i+1) - l_i)),      Omega = the solid angle,
    4 pi psi = sum_i h_i L_i - d Omega,                           P = sum_i L_i m_i,
    4 pi phi_k = lambda_k Omega - d g_k . P,

where lambda_k are the barycentric coordinates of the foot on the triangle's plane, and g_k their gradients. An edge's L
is the same in the two triangles that it bounds; the closed forms of the gradients need no more than the edges either.

Arguments are those of :mod:`pliant.numerics.coordinates.mean_value`, and
``plane``
    (t, 16) for each triangle n, the m_i, l_o / 2A for the edge opposite each corner, and 2A.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel
from pliant.numerics.compute.lane_functions import angle, log_ratio, magnitude, where_less, with_sign
from pliant.numerics.compute.lanes import get, load, spread, store
from pliant.numerics.coordinates.sight import edge_seen, look, measure_arms

_TINY = 1e-60  # squared, still a number
_PART = 0.07957747154594767  # 1 / 4 pi
_EDGE, _SLOPE = 16, 80  # numbers kept for an edge: 2 or 10 times eight lanes


@inlined
def _logarithms(edges, lines, arms, lengths, kept, width):
    """For each edge: L, and the product of the arms to its ends."""
    zero = spread(0.0)
    for e in range(len(edges)):
        cx, cy, cz, cosine, length = edge_seen(e, edges, lines, arms)
        one, two = load(lengths, 8 * edges[e, 0]), load(lengths, 8 * edges[e, 1])
        around = one + two
        longer, product = around + length, one * two
        square = cx * cx + cy * cy + cz * cz
        top = where_less(cosine, zero, longer * longer * (product - cosine), longer)
        bottom = where_less(cosine, zero, 2.0 * square, around - length)
        store(kept, width * e, log_ratio(top, where_less(zero + _TINY, bottom, bottom, zero + _TINY)))
        store(kept, width * e + 8, cosine)


@inlined
def _triangle(t, triangles, sides, arms, lengths, kept, width, plane):
    """P, d, the solid angle and 4 pi psi of a triangle."""
    zero = spread(0.0)
    x, y, z = zero, zero, zero
    psi, opposite = zero, zero
    for k in range(3):  # the side opposite corner k begins at corner k + 1
        logarithm, cosine = load(kept, width * (sides[t, k] // 2)), load(kept, width * (sides[t, k] // 2) + 8)
        i = (k + 1) % 3
        a = 24 * triangles[t, i]
        mx, my, mz = plane[t, 3 + 3 * i], plane[t, 4 + 3 * i], plane[t, 5 + 3 * i]
        x, y, z = x + logarithm * mx, y + logarithm * my, z + logarithm * mz
        psi = psi + (load(arms, a) * mx + load(arms, a + 8) * my + load(arms, a + 16) * mz) * logarithm
        opposite = opposite + cosine * load(lengths, 8 * triangles[t, k])
    a = 24 * triangles[t, 0]
    d = load(arms, a) * plane[t, 0] + load(arms, a + 8) * plane[t, 1] + load(arms, a + 16) * plane[t, 2]
    size = plane[t, 15]
    product = load(lengths, 8 * triangles[t, 0]) * load(lengths, 8 * triangles[t, 1])
    product = product * load(lengths, 8 * triangles[t, 2])
    omega = with_sign(2.0 * angle(magnitude(d) * size, product + opposite, zero), d)
    return x, y, z, d, omega, psi - d * omega


@kernel
def green_weights(points, first, stop, vertices, edges, lines, triangles, sides, plane, phi, psi):
    """Phi (n, m) and psi (n, t), from row ``first`` on."""
    count = len(vertices) // 3
    tail, arms, lengths = np.empty(24), np.empty(24 * count), np.empty(8 * count)
    kept, sums, stretch = np.empty(_EDGE * len(edges)), np.empty(8 * count), np.empty(8 * len(triangles))
    for n in range(first, stop, 8):
        look(points, tail, n, stop, vertices, arms)
        measure_arms(arms, lengths)
        _logarithms(edges, lines, arms, lengths, kept, _EDGE)
        sums[:] = 0.0
        for t in range(len(triangles)):
            x, y, z, d, omega, part = _triangle(t, triangles, sides, arms, lengths, kept, _EDGE, plane)
            store(stretch, 8 * t, part * _PART)
            for k in range(3):
                i = (k + 1) % 3
                a, at = 24 * triangles[t, i], 8 * triangles[t, k]
                mx, my, mz = plane[t, 3 + 3 * i], plane[t, 4 + 3 * i], plane[t, 5 + 3 * i]
                height = load(arms, a) * mx + load(arms, a + 8) * my + load(arms, a + 16) * mz
                weight = (height * omega + d * (x * mx + y * my + z * mz)) * (_PART * plane[t, 12 + k])
                store(sums, at, load(sums, at) + weight)
        for lane in range(min(8, stop - n)):
            for j in range(count):
                phi[n + lane, j] = get(sums, 8 * j + lane)
            for t in range(len(triangles)):
                psi[n + lane, t] = get(stretch, 8 * t + lane)


@inlined
def _edge_slopes(edges, lines, arms, lengths, kept):
    """For each edge, beyond L: its gradient (3), and the edge's part of that of solid angles (3)."""
    zero = spread(0.0)
    for e in range(len(edges)):
        p, q, at = 24 * edges[e, 0], 24 * edges[e, 1], _SLOPE * e
        cx, cy, cz, _, length = edge_seen(e, edges, lines, arms)
        one, two, cosine = load(lengths, 8 * edges[e, 0]), load(lengths, 8 * edges[e, 1]), load(kept, at + 8)
        square, product = cx * cx + cy * cy + cz * cz, one * two
        gap = where_less(cosine, zero, square / (product - cosine + _TINY), product + cosine)
        inverse = 1.0 / (gap + _TINY)
        turn = (one + two) * inverse / (product + _TINY)
        length = length * inverse
        first, second = length / (one + _TINY), length / (two + _TINY)
        store(kept, at + 16, load(arms, p) * first + load(arms, q) * second)
        store(kept, at + 24, load(arms, p + 8) * first + load(arms, q + 8) * second)
        store(kept, at + 32, load(arms, p + 16) * first + load(arms, q + 16) * second)
        store(kept, at + 40, cx * turn)
        store(kept, at + 48, cy * turn)
        store(kept, at + 56, cz * turn)


@kernel
def green_jacobians(points, first, stop, vertices, edges, lines, triangles, sides, plane, moves, tilts, pulls, out):
    """Out (n, 9), flat = identity + the derivative of sum phi u + sum psi f.

    ``moves`` (3 m,) are the u, ``pulls`` (3 t,) the f; ``tilts`` (t, 9) is sum_k u_k g_k for each triangle.
    """
    count = len(vertices) // 3
    tail, arms, lengths = np.empty(24), np.empty(24 * count), np.empty(8 * count)
    kept, sums, bent = np.empty(_SLOPE * len(edges)), np.empty(72), np.empty(48)
    for n in range(first, stop, 8):
        look(points, tail, n, stop, vertices, arms)
        measure_arms(arms, lengths)
        _logarithms(edges, lines, arms, lengths, kept, _SLOPE)
        _edge_slopes(edges, lines, arms, lengths, kept)
        sums[:] = 0.0
        for t in range(len(triangles)):
            x, y, z, d, omega, _ = _triangle(t, triangles, sides, arms, lengths, kept, _SLOPE, plane)
            gradient = (omega * plane[t, 0] - x, omega * plane[t, 1] - y, omega * plane[t, 2] - z)
            turn = (spread(0.0), spread(0.0), spread(0.0))
            for k in range(3):
                at, sign = _SLOPE * (sides[t, k] // 2), 1.0 - 2.0 * (sides[t, k] % 2)
                turn = (
                    turn[0] + sign * load(kept, at + 40),
                    turn[1] + sign * load(kept, at + 48),
                    turn[2] + sign * load(kept, at + 56),
                )
            corner = 24 * triangles[t, 0]
            ax, ay, az = load(arms, corner), load(arms, corner + 8), load(arms, corner + 16)
            for a in range(3):
                ux, uy, uz = tilts[t, 3 * a], tilts[t, 3 * a + 1], tilts[t, 3 * a + 2]
                move = get(moves, 3 * triangles[t, 0] + a) - (ax * ux + ay * uy + az * uz)
                leaning = x * ux + y * uy + z * uz
                for k in range(3):
                    i = (k + 1) % 3
                    along = ux * plane[t, 3 + 3 * i] + uy * plane[t, 4 + 3 * i] + uz * plane[t, 5 + 3 * i]
                    store(bent, 8 * k, d * along)
                pull = get(pulls, 3 * t + a)
                for b in range(3):
                    grown = load(sums, 24 * a + 8 * b) + gradient[b] * pull + omega * tilts[t, 3 * a + b]
                    grown = grown + move * turn[b] + leaning * plane[t, b]
                    for k in range(3):
                        grown = grown - load(bent, 8 * k) * load(kept, _SLOPE * (sides[t, k] // 2) + 16 + 8 * b)
                    store(sums, 24 * a + 8 * b, grown)
        for lane in range(min(8, stop - n)):
            for entry in range(9):
                out[9 * (n + lane) + entry] = get(sums, 8 * entry + lane) * _PART + (1.0 if entry % 4 == 0 else 0.0)
