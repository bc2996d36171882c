"""Kernels for maximum entropy coordinates: the weights that say least beyond what priors and linear precision say.

Of all weights with sum_i w_i = 1 and sum_i w_i a_i = 0, a_i from the point to vertex i, those closest to priors p_i in
relative entropy are w_i = p_i exp(-lambda . a_i) / Z, where lambda minimises ln Z: three unknowns a point, a convex
function, Newton's method (Hormann & Sukumar 2008, eq. 11 to 16). The prior of a vertex is the product of 1 / rho over
the triangles at it; rho of a triangle with corners a, b, c, (|a x b| + |b x c| + |c x a|) / 2 - area, is zero on the
triangle and nowhere else, so that on a triangle only its own corners have weights.
"""

from __future__ import annotations

import math

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel

_ENOUGH = 1e-14  # of what the weights miss the point by, in diagonals
_ROUNDS = 200
_FARTHEST = 20.0  # a step of lambda: no weight changes by more than e^20 against another
_LEAST = 1e-18


@inlined
def _priors(x, y, z, vertices, edges, lines, arms, crossed, logs):
    """Arms (3 m,) and |c| of each edge; the logarithms of the priors begin at zero."""
    count = len(vertices) // 3
    for j in range(count):
        arms[3 * j], arms[3 * j + 1], arms[3 * j + 2] = (
            vertices[3 * j] - x,
            vertices[3 * j + 1] - y,
            vertices[3 * j + 2] - z,
        )
        logs[j] = 0.0
    for e in range(len(edges)):
        p = 3 * edges[e, 0]
        px, py, pz = arms[p], arms[p + 1], arms[p + 2]
        ex, ey, ez = lines[3 * e], lines[3 * e + 1], lines[3 * e + 2]
        cx, cy, cz = py * ez - pz * ey, pz * ex - px * ez, px * ey - py * ex
        crossed[e] = math.sqrt(cx * cx + cy * cy + cz * cz)


@inlined
def _rho(t, sides, areas, crossed):
    total = 0.5 * (crossed[sides[t, 0] // 2] + crossed[sides[t, 1] // 2] + crossed[sides[t, 2] // 2]) - areas[t]
    return max(total, _LEAST)


@inlined
def _evaluate(logs, arms, l0, l1, l2, weights, state):
    """The value of ln Z; weights, their mean of the arms (3) and second moments (6) in ``state``."""
    top = -1e300
    count = len(logs)
    for j in range(count):
        weights[j] = logs[j] - l0 * arms[3 * j] - l1 * arms[3 * j + 1] - l2 * arms[3 * j + 2]
        top = max(top, weights[j])
    total = 0.0
    for n in range(9):
        state[n] = 0.0
    for j in range(count):
        w = math.exp(weights[j] - top)
        weights[j] = w
        total += w
        a, b, c = arms[3 * j], arms[3 * j + 1], arms[3 * j + 2]
        state[0] += w * a
        state[1] += w * b
        state[2] += w * c
        state[3] += w * a * a
        state[4] += w * a * b
        state[5] += w * a * c
        state[6] += w * b * b
        state[7] += w * b * c
        state[8] += w * c * c
    for n in range(9):
        state[n] /= total
    for j in range(count):
        weights[j] /= total
    return top + math.log(total)


@inlined
def _covariance(state, matrix):
    """The inverse (9,) of the weights' covariance of the arms."""
    a, b, c = state[0], state[1], state[2]
    xx, xy, xz = state[3] - a * a, state[4] - a * b, state[5] - a * c
    yy, yz, zz = state[6] - b * b, state[7] - b * c, state[8] - c * c
    room = 1e-15 * (xx + yy + zz)
    xx, yy, zz = xx + room, yy + room, zz + room
    i, j, k = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    det = xx * i + xy * j + xz * k
    matrix[0], matrix[1], matrix[2] = i / det, j / det, k / det
    matrix[3], matrix[4], matrix[5] = j / det, (xx * zz - xz * xz) / det, (xy * xz - xx * yz) / det
    matrix[6], matrix[7], matrix[8] = k / det, (xy * xz - xx * yz) / det, (xx * yy - xy * xy) / det


@inlined
def _solve(logs, arms, weights, state, matrix):
    """Weights whose mean of the arms is zero; what is left of it."""
    l0, l1, l2 = 0.0, 0.0, 0.0
    value = _evaluate(logs, arms, l0, l1, l2, weights, state)
    for _ in range(_ROUNDS):
        missed = math.sqrt(state[0] * state[0] + state[1] * state[1] + state[2] * state[2])
        if missed < _ENOUGH:
            break
        _covariance(state, matrix)
        d0 = matrix[0] * state[0] + matrix[1] * state[1] + matrix[2] * state[2]
        d1 = matrix[3] * state[0] + matrix[4] * state[1] + matrix[5] * state[2]
        d2 = matrix[6] * state[0] + matrix[7] * state[1] + matrix[8] * state[2]
        gain = d0 * state[0] + d1 * state[1] + d2 * state[2]
        step, lower = min(1.0, _FARTHEST / math.sqrt(d0 * d0 + d1 * d1 + d2 * d2)), False
        for _ in range(30):
            tried = _evaluate(logs, arms, l0 + step * d0, l1 + step * d1, l2 + step * d2, weights, state)
            now = math.sqrt(state[0] * state[0] + state[1] * state[1] + state[2] * state[2])
            if tried <= value - 0.1 * step * gain or now < 0.5 * missed:
                lower = True
                break
            step *= 0.5
        if not lower:
            break
        l0, l1, l2, value = l0 + step * d0, l1 + step * d1, l2 + step * d2, tried
    return l0, l1, l2


@kernel
def entropy_weights(points, first, stop, vertices, edges, lines, triangles, sides, areas, out, missed):
    """Out (n, m) from row ``first`` on, for points inside; missed (n,): how far the weights' mean is from the point."""
    count = len(vertices) // 3
    arms, crossed, logs = np.empty(3 * count), np.empty(len(edges)), np.empty(count)
    weights, state, matrix = np.empty(count), np.empty(9), np.empty(9)
    for n in range(first, stop):
        x, y, z = points[3 * n], points[3 * n + 1], points[3 * n + 2]
        _priors(x, y, z, vertices, edges, lines, arms, crossed, logs)
        for t in range(len(triangles)):
            less = math.log(_rho(t, sides, areas, crossed))
            for k in range(3):
                logs[triangles[t, k]] -= less
        _solve(logs, arms, weights, state, matrix)
        missed[n] = math.sqrt(state[0] * state[0] + state[1] * state[1] + state[2] * state[2])
        for j in range(count):
            out[n, j] = weights[j]


@inlined
def _prior_slopes(edges, lines, triangles, sides, areas, arms, crossed, logs, slopes):
    """The logarithms of the priors, and their gradients (3 m,)."""
    slopes[:] = 0.0
    gradient = np.empty(3)
    for t in range(len(triangles)):
        rho = _rho(t, sides, areas, crossed)
        gradient[:] = 0.0
        for k in range(3):
            e = sides[t, k] // 2
            p = 3 * edges[e, 0]
            px, py, pz = arms[p], arms[p + 1], arms[p + 2]
            ex, ey, ez = lines[3 * e], lines[3 * e + 1], lines[3 * e + 2]
            cx, cy, cz = py * ez - pz * ey, pz * ex - px * ez, px * ey - py * ex
            part = 0.5 / (rho * max(crossed[e], 1e-300))
            gradient[0] += part * (cy * ez - cz * ey)
            gradient[1] += part * (cz * ex - cx * ez)
            gradient[2] += part * (cx * ey - cy * ex)
        for k in range(3):
            logs[triangles[t, k]] -= math.log(rho)
            for b in range(3):
                slopes[3 * triangles[t, k] + b] -= gradient[b]


@inlined
def _turning(weights, slopes, arms, matrix, mean, moment, turned):
    """The weights' mean of the slopes, and (9,) how lambda changes with the point."""
    mean[:] = 0.0
    moment[:] = 0.0
    for j in range(len(weights)):
        for b in range(3):
            mean[b] += weights[j] * slopes[3 * j + b]
            for a in range(3):
                moment[3 * a + b] += weights[j] * arms[3 * j + a] * slopes[3 * j + b]
    for a in range(3):
        moment[4 * a] -= 1.0
    for entry in range(9):
        a, b = entry // 3, entry % 3
        turned[entry] = (
            matrix[3 * a] * moment[b] + matrix[3 * a + 1] * moment[3 + b] + matrix[3 * a + 2] * moment[6 + b]
        )


@kernel
def entropy_jacobians(points, first, stop, vertices, edges, lines, triangles, sides, areas, moves, out):
    """Out (n, 9), flat = identity + the derivative of the interpolated moves (3 m,), by the implicit function theorem.

    With w_i = p_i exp(-lambda . a_i) / Z, the derivative of ln w_i is that of ln p_i - lambda . a_i but for its mean,
    and lambda changes so that the mean of the arms stays zero.
    """
    count = len(vertices) // 3
    arms, crossed, logs = np.empty(3 * count), np.empty(len(edges)), np.empty(count)
    weights, state, matrix = np.empty(count), np.empty(9), np.empty(9)
    slopes, mean, moment, turned = np.empty(3 * count), np.empty(3), np.empty(9), np.empty(9)
    for n in range(first, stop):
        x, y, z = points[3 * n], points[3 * n + 1], points[3 * n + 2]
        _priors(x, y, z, vertices, edges, lines, arms, crossed, logs)
        _prior_slopes(edges, lines, triangles, sides, areas, arms, crossed, logs, slopes)
        _solve(logs, arms, weights, state, matrix)
        _covariance(state, matrix)
        _turning(weights, slopes, arms, matrix, mean, moment, turned)
        for entry in range(9):
            out[9 * n + entry] = 1.0 if entry % 4 == 0 else 0.0
        for j in range(count):
            for b in range(3):
                change = slopes[3 * j + b] - mean[b]
                for c in range(3):
                    change -= arms[3 * j + c] * turned[3 * c + b]
                for a in range(3):
                    out[9 * n + 3 * a + b] += weights[j] * change * moves[3 * j + a]
