"""Kernels for one block of tricubic hyperpatches of any shape: its map from parameters to space, and the inverse.

A block is a grid of cells, each with 4 x 4 x 4 control values. Arguments that the kernels share:

``lattice, shape``
    Control values, flat, of shape (x, y, z, 3), and (x, y, z); wrapped axes are written out.
``cells, strides, bases, wrapped``
    (3,) numbers of cells; control values from one cell to the next; (3, 4, 4) coefficient of power p in basis
    function b at [axis, p, b]; whether parameters are taken modulo the number of cells.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel


@kernel
def invert(
    points, first, stop, lattice, shape, cells, strides, bases, wrapped, seeds, enough, iterations,
    parameters, residuals, counts,
):  # fmt: skip
    """Parameters whose image is nearest to each point, by Levenberg and Marquardt from the best of some seeds.

    Parameters
    ----------
    points
        (n, 3) positions.
    seeds
        (n, s, 3) parameters to begin with, the most promising first.
    enough
        Residual below which no further seed is tried, nor step taken.
    iterations
        Most steps from a seed.
    parameters, residuals, counts
        (n, 3), (n,) and (n,): the answers, their distances from the points, and the steps that the seed took.
    """
    value, slope = np.empty(3), np.empty((3, 3))
    weights, index = np.empty((2, 3, 4)), np.empty(3, np.int64)
    q, trial, normal, step = np.empty(3), np.empty(3), np.empty((3, 4)), np.empty(3)
    for n in range(first, stop):
        residuals[n] = np.inf
        for seed in range(seeds.shape[1]):
            for axis in range(3):
                q[axis] = seeds[n, seed, axis]
            _confine(q, cells, wrapped)
            _map(q, lattice, shape, cells, strides, bases, weights, index, value, slope)
            error, damping, steps = _distance(points[n], value), 0.0, 0
            while steps < iterations and error > enough:
                steps += 1
                _normal_equations(points[n], value, slope, damping, normal)
                _solve(normal, step)
                length = 0.0
                for axis in range(3):
                    trial[axis] = q[axis] + step[axis]
                    length += step[axis] ** 2
                _confine(trial, cells, wrapped)
                _map(trial, lattice, shape, cells, strides, bases, weights, index, value, slope)
                reached = _distance(points[n], value)
                if reached < error:
                    gained = error - reached
                    q[:], error, damping = trial, reached, 0.1 * damping if damping > 1e-9 else 0.0
                    if gained < 1e-3 * enough:
                        break
                else:
                    if (length < 1e-28 and damping > 0.0) or damping > 1e6:
                        break
                    damping = max(10 * damping, 1e-4)
                    _map(q, lattice, shape, cells, strides, bases, weights, index, value, slope)
            if error < residuals[n]:
                residuals[n], counts[n] = error, steps
                parameters[n] = q
            if residuals[n] <= enough:
                break


@kernel
def differentiate(parameters, first, stop, lattice, shape, cells, strides, bases, values, slopes):
    """(n, 3) images of (n, 3) parameters, and (n, 3, 3) derivatives: column = parameter."""
    weights, index = np.empty((2, 3, 4)), np.empty(3, np.int64)
    for n in range(first, stop):
        _map(parameters[n], lattice, shape, cells, strides, bases, weights, index, values[n], slopes[n])


@kernel
def spread_basis(parameters, first, stop, shape, cells, strides, bases, places, shares):
    """(n, 64) which control values each parameter uses, and their basis functions there."""
    weights, index = np.empty((2, 3, 4)), np.empty(3, np.int64)
    for n in range(first, stop):
        _basis(parameters[n], cells, strides, bases, weights, index)
        for i in range(4):
            for j in range(4):
                for k in range(4):
                    at = ((index[0] + i) * shape[1] + index[1] + j) * shape[2] + index[2] + k
                    places[n, 16 * i + 4 * j + k] = at
                    shares[n, 16 * i + 4 * j + k] = weights[0, 0, i] * weights[0, 1, j] * weights[0, 2, k]


@inlined
def _basis(q, cells, strides, bases, weights, index):
    """Basis functions and derivatives along each axis, and where their control values begin."""
    for axis in range(3):
        cell = min(max(int(np.floor(q[axis])), 0), cells[axis] - 1)
        t = q[axis] - cell
        index[axis] = cell * strides[axis]
        for b in range(4):
            c0, c1, c2, c3 = bases[axis, 0, b], bases[axis, 1, b], bases[axis, 2, b], bases[axis, 3, b]
            weights[0, axis, b] = c0 + t * (c1 + t * (c2 + t * c3))
            weights[1, axis, b] = c1 + t * (2 * c2 + 3 * t * c3)


@inlined
def _map(q, lattice, shape, cells, strides, bases, weights, index, value, slope):
    """Image of a parameter, and the derivative there."""
    _basis(q, cells, strides, bases, weights, index)
    value[:] = 0.0
    slope[:] = 0.0
    for i in range(4):
        for j in range(4):
            base = 3 * (((index[0] + i) * shape[1] + index[1] + j) * shape[2] + index[2])
            for axis in range(3):
                total, along = 0.0, 0.0
                for k in range(4):
                    total += weights[0, 2, k] * lattice[base + 3 * k + axis]
                    along += weights[1, 2, k] * lattice[base + 3 * k + axis]
                value[axis] += weights[0, 0, i] * weights[0, 1, j] * total
                slope[axis, 0] += weights[1, 0, i] * weights[0, 1, j] * total
                slope[axis, 1] += weights[0, 0, i] * weights[1, 1, j] * total
                slope[axis, 2] += weights[0, 0, i] * weights[0, 1, j] * along


@inlined
def _confine(q, cells, wrapped):
    """Parameters back into the block."""
    for axis in range(3):
        if wrapped[axis]:
            q[axis] -= cells[axis] * np.floor(q[axis] / cells[axis])
        q[axis] = min(max(q[axis], 0.0), float(cells[axis]))


@inlined
def _distance(point, value):
    return np.sqrt((point[0] - value[0]) ** 2 + (point[1] - value[1]) ** 2 + (point[2] - value[2]) ** 2)


@inlined
def _normal_equations(point, value, slope, damping, normal):
    """(3, 4) J^T J, damped on its diagonal, and J^T r; undamped where J is safe to invert: J and r themselves."""
    for i in range(3):
        for j in range(4):
            normal[i, j] = slope[i, j] if j < 3 else point[i] - value[i]
    if damping == 0.0:
        return
    for i in range(3):
        for j in range(3):
            total = 0.0
            for k in range(3):
                total += slope[k, i] * slope[k, j]
            normal[i, j] = total
        total = 0.0
        for k in range(3):
            total += slope[k, i] * (point[k] - value[k])
        normal[i, 3] = total
    trace = normal[0, 0] + normal[1, 1] + normal[2, 2]
    for i in range(3):
        normal[i, i] += damping * (normal[i, i] + 1e-3 * trace)


@inlined
def _solve(a, x):
    """Solve three equations (3, 4) by elimination with row exchanges; where they are singular the step is zero."""
    size = 0.0
    for i in range(3):
        for j in range(3):
            size = max(size, abs(a[i, j]))
    for c in range(3):
        best = c
        for i in range(c + 1, 3):
            if abs(a[i, c]) > abs(a[best, c]):
                best = i
        for j in range(4):
            a[c, j], a[best, j] = a[best, j], a[c, j]
        if abs(a[c, c]) <= 1e-14 * size:
            x[:] = 0.0
            return
        for i in range(c + 1, 3):
            factor = a[i, c] / a[c, c]
            for j in range(c, 4):
                a[i, j] -= factor * a[c, j]
    for i in range(2, -1, -1):
        total = a[i, 3]
        for j in range(i + 1, 3):
            total -= a[i, j] * x[j]
        x[i] = total / a[i, i]
