"""Kernels for mean value coordinates of triangle cages, in the form of mean vectors (Ju, Schaefer & Warren 2005).

Seen from a point, a triangle with corners a_0, a_1, a_2 has the mean vector

    m = 1/2 sum_i theta_i c_i / |c_i|,    c_i = a_(i+1) x a_(i+2),    theta_i = angle between a_(i+1) and a_(i+2),

and adds w_i = (c_i . m) / det(a_0, a_1, a_2) to the weights of its corners, which solves sum_i w_i a_i = m. An edge's
part of m is the same, but for its sign, in the two triangles that it bounds: it is computed once, so that the mean
vectors of a closed cage add up to zero whatever the rounding, and linear functions are reproduced.

Eight points go through the arithmetic at once. Arguments that the kernels share:

``points, first, stop``
    Flat coordinates, and the piece of them that is meant, in a unit in which the cage's diagonal is one.
``vertices, edges, lines``
    Flat coordinates of the cage's vertices; (e, 2) vertices; (3 e,) the vectors from the first to the second.
``triangles, sides``
    (t, 3) vertices; (t, 3) the edge opposite each, as 2 * edge, plus 1 where the triangle runs through it backwards.
``duals``
    (3 m,) vectors with sum_j duals_j = 0 and sum_j v_j duals_j^T = 1: what corrects the weights' mean of the vertices.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel
from pliant.numerics.compute.lane_functions import angle, magnitude, where_less
from pliant.numerics.compute.lanes import get, load, root, spread, store
from pliant.numerics.coordinates.sight import TOUCHING, edge_seen, look

_NOISE = 1e-15  # of c . m, relative to its factors: what is below is a triangle seen exactly from its side
_TINY = 1e-300
_EDGE, _SLOPE = 48, 128  # numbers kept for an edge: 6 or 16 times eight lanes


@inlined
def _edges(edges, lines, arms, kept, width, met):
    """For each edge: c, half of theta / |c|, |c|, theta; lanes that are 1 where an edge is met, too."""
    zero = spread(0.0)
    for e in range(len(edges)):
        cx, cy, cz, cosine, length = edge_seen(e, edges, lines, arms)
        sine = root(cx * cx + cy * cy + cz * cz)
        theta = angle(sine, cosine, zero)
        at = width * e
        store(kept, at, cx)
        store(kept, at + 8, cy)
        store(kept, at + 16, cz)
        store(kept, at + 24, 0.5 * theta / (sine + _TINY))
        store(kept, at + 32, sine)
        store(kept, at + 40, theta)
        on_line = where_less(sine, zero + TOUCHING * length, zero + 1.0, zero)
        met = where_less(cosine, zero, met + on_line, met)
    return met


@inlined
def _corners(triangle, side, arms, kept, width):
    """A triangle's mean vector, its determinant, and the weight of each corner."""
    mx, my, mz, angles = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    for i in range(3):
        at, sign = width * (side[i] // 2), 1.0 - 2.0 * (side[i] % 2)
        f = sign * load(kept, at + 24)
        mx, my, mz = mx + f * load(kept, at), my + f * load(kept, at + 8), mz + f * load(kept, at + 16)
        angles = angles + load(kept, at + 40)
    at, sign, a = width * (side[0] // 2), 1.0 - 2.0 * (side[0] % 2), 24 * triangle[0]
    det = load(arms, a) * load(kept, at) + load(arms, a + 8) * load(kept, at + 8)
    det = sign * (det + load(arms, a + 16) * load(kept, at + 16))
    inverse = 1.0 / det
    return mx, my, mz, inverse, angles * _NOISE


@inlined
def _weight(side, kept, width, mx, my, mz, inverse, noise):
    at, sign = width * (side // 2), 1.0 - 2.0 * (side % 2)
    part = load(kept, at) * mx + load(kept, at + 8) * my + load(kept, at + 16) * mz
    return where_less(magnitude(part), noise * load(kept, at + 32), spread(0.0), sign * part * inverse)


@inlined
def _correct(sums, arms, duals):
    """Give the weights the mean that triangles seen exactly from their sides, left out, have taken from it."""
    x, y, z = spread(0.0), spread(0.0), spread(0.0)
    for at in range(0, len(sums), 8):
        weight = load(sums, at)
        x, y, z = (
            x + weight * load(arms, 3 * at),
            y + weight * load(arms, 3 * at + 8),
            z + weight * load(arms, 3 * at + 16),
        )
    for j in range(len(sums) // 8):
        shift = x * get(duals, 3 * j) + y * get(duals, 3 * j + 1) + z * get(duals, 3 * j + 2)
        store(sums, 8 * j, load(sums, 8 * j) - shift)


@kernel
def mean_value_weights(points, first, stop, vertices, edges, lines, triangles, sides, duals, out, place):
    """Out (n, m) from row ``first`` on; ``place`` (n,) is 1 inside the cage, -1 outside, 0 where a point touches it.

    Inside, all that is seen from within adds up to more than nothing; outside it adds up to less. Rows of points that
    touch the cage are zero: they are to be made otherwise.
    """
    count = len(vertices) // 3
    tail, arms, kept = np.empty(24), np.empty(24 * count), np.empty(_EDGE * len(edges))
    sums, piece, flags = np.empty(8 * count), np.empty(8), np.empty(8)
    for n in range(first, stop, 8):
        met = look(points, tail, n, stop, vertices, arms)
        met = _edges(edges, lines, arms, kept, _EDGE, met)
        sums[:] = 0.0
        total = spread(0.0)
        for t in range(len(triangles)):
            mx, my, mz, inverse, noise = _corners(triangles[t], sides[t], arms, kept, _EDGE)
            for i in range(3):
                weight = _weight(sides[t, i], kept, _EDGE, mx, my, mz, inverse, noise)
                at = 8 * triangles[t, i]
                store(sums, at, load(sums, at) + weight)
                total = total + weight
        store(piece, 0, 1.0 / total)
        store(flags, 0, met)
        _correct(sums, arms, duals)
        for lane in range(min(8, stop - n)):
            scale = piece[lane]
            touching = flags[lane] > 0.0 or not 1e-15 < abs(scale) < 1e300
            place[n + lane] = 0 if touching else (1 if scale > 0.0 else -1)
            if touching:
                scale = 0.0
            for j in range(count):
                out[n + lane, j] = get(sums, 8 * j + lane) * scale


@inlined
def _edge_slopes(edges, lines, arms, kept):
    """For each edge, beyond what :func:`_edges` keeps: k, with d(theta / 2|c|) = k . dx."""
    for e in range(len(edges)):
        p, q, at = 24 * edges[e, 0], 24 * edges[e, 1], _SLOPE * e
        px, py, pz = load(arms, p), load(arms, p + 8), load(arms, p + 16)
        qx, qy, qz = load(arms, q), load(arms, q + 8), load(arms, q + 16)
        ex, ey, ez = get(lines, 3 * e), get(lines, 3 * e + 1), get(lines, 3 * e + 2)
        cx, cy, cz = load(kept, at), load(kept, at + 8), load(kept, at + 16)
        sine, theta = load(kept, at + 32), load(kept, at + 40)
        cosine = px * qx + py * qy + pz * qz
        square = sine * sine
        product = square + cosine * cosine
        safe = 1.0 / (square + _TINY)
        straight = (cosine / product - theta / (sine + _TINY)) * safe
        t = square / (cosine * cosine + _TINY)  # where the edge is seen short, the difference is a series
        series = (((t * (10 / 11) - 8 / 9) * t + 6 / 7) * t * -1.0 + 4 / 5) * t - 2 / 3
        short = series / (cosine * cosine * cosine + _TINY)
        part = where_less(t, spread(1e-4), where_less(spread(0.0), cosine, short, straight), straight)
        both = 1.0 / product
        store(kept, at + 48, 0.5 * ((cy * ez - cz * ey) * part + (px + qx) * both))
        store(kept, at + 56, 0.5 * ((cz * ex - cx * ez) * part + (py + qy) * both))
        store(kept, at + 64, 0.5 * ((cx * ey - cy * ex) * part + (pz + qz) * both))


@inlined
def _spin(side, lines, kept, slope):
    """Add an edge's part to M (72,), with dm = M dx for the triangle's mean vector."""
    edge, sign = side // 2, 1.0 - 2.0 * (side % 2)
    at = _SLOPE * edge
    f = sign * load(kept, at + 24)
    for a in range(3):
        c = sign * load(kept, at + 8 * a)
        for b in range(3):
            store(slope, 24 * a + 8 * b, load(slope, 24 * a + 8 * b) + c * load(kept, at + 48 + 8 * b))
        after, before = (a + 1) % 3, (a + 2) % 3
        near, far = 24 * a + 8 * before, 24 * a + 8 * after
        store(slope, near, load(slope, near) + f * get(lines, 3 * edge + after))
        store(slope, far, load(slope, far) - f * get(lines, 3 * edge + before))


@kernel
def mean_value_jacobians(points, first, stop, vertices, edges, lines, triangles, sides, normals, moves, out):
    """Out (n, 9), flat = identity + the derivative of the interpolated displacements ``moves`` (3 m,).

    ``normals`` (3 t,) are the triangles', twice as long as their areas.
    """
    count = len(vertices) // 3
    tail, arms, kept = np.empty(24), np.empty(24 * count), np.empty(_SLOPE * len(edges))
    slope, sums, piece = np.empty(72), np.empty(136), np.empty(72)
    for n in range(first, stop, 8):
        look(points, tail, n, stop, vertices, arms)
        _edges(edges, lines, arms, kept, _SLOPE, spread(0.0))
        _edge_slopes(edges, lines, arms, kept)
        sums[:] = 0.0  # at 0: S (9), at 72: d (3), at 96: total, at 104: its slope (3)
        for t in range(len(triangles)):
            mx, my, mz, inverse, noise = _corners(triangles[t], sides[t], arms, kept, _SLOPE)
            slope[:] = 0.0
            for i in range(3):
                _spin(sides[t, i], lines, kept, slope)
            for i in range(3):
                side = sides[t, i]
                weight = _weight(side, kept, _SLOPE, mx, my, mz, inverse, noise)
                edge, sign = side // 2, 1.0 - 2.0 * (side % 2)
                at = _SLOPE * edge
                cx, cy, cz = load(kept, at), load(kept, at + 8), load(kept, at + 16)
                store(sums, 96, load(sums, 96) + weight)
                here = where_less(magnitude(weight), spread(_TINY), spread(0.0), inverse)
                for b in range(3):
                    after, before = (b + 1) % 3, (b + 2) % 3
                    m_after = mx if after == 0 else (my if after == 1 else mz)
                    m_before = mx if before == 0 else (my if before == 1 else mz)
                    spun = m_after * get(lines, 3 * edge + before) - m_before * get(lines, 3 * edge + after)
                    spun = spun + cx * load(slope, 8 * b) + cy * load(slope, 24 + 8 * b) + cz * load(slope, 48 + 8 * b)
                    slant = (sign * spun + weight * get(normals, 3 * t + b)) * here
                    store(sums, 104 + 8 * b, load(sums, 104 + 8 * b) + slant)
                    for a in range(3):
                        move = get(moves, 3 * triangles[t, i] + a)
                        store(sums, 24 * a + 8 * b, load(sums, 24 * a + 8 * b) + slant * move)
                for a in range(3):
                    move = get(moves, 3 * triangles[t, i] + a)
                    store(sums, 72 + 8 * a, load(sums, 72 + 8 * a) + weight * move)
        inverse = 1.0 / load(sums, 96)
        for a in range(3):
            mean = load(sums, 72 + 8 * a) * inverse
            for b in range(3):
                change = (load(sums, 24 * a + 8 * b) - mean * load(sums, 104 + 8 * b)) * inverse
                store(piece, 24 * a + 8 * b, change)
        for lane in range(min(8, stop - n)):
            for entry in range(9):
                out[9 * (n + lane) + entry] = piece[8 * entry + lane] + (1.0 if entry % 4 == 0 else 0.0)
