"""Kernels for tricubic tensor products on a grid of cells: what B-spline and Bézier lattices share.

Points are sorted by cell within chunks that fit the cache. Inside a cell the 64 control points are the same for all
points, so that eight points go through the arithmetic at once (see :mod:`pliant.numerics.compute.lanes`), and
scattering the results stays within the chunk.

Arguments that the kernels share:

``first, starts``
    Place of the chunk's first point; (cells + 2,) where each cell's run begins in the chunk. The last run holds the
    points that no cell owns.
``order, places, local``
    (n,) which point stands at each sorted place; (n,) at which place of its chunk each point stands; (3 * (n + 8),)
    the sorted points' coordinates in their cells, one axis after another.
``grid, stride, basis``
    (3,) numbers of cells; control points from one cell to the next (1 for B-splines, 3 for Bézier patches);
    (4, 4) coefficient of power p in basis function b at [p, b].
``lattice, shape``
    Control values, flat, of shape (x, y, z, 3), and (x, y, z).
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel
from pliant.numerics.compute.lanes import (
    add_triple,
    affine,
    clamp,
    clear,
    cubic,
    get,
    load,
    load_triples,
    put,
    spread,
    store,
    store_triples,
    total,
    weighted,
    where_between,
    whole,
)


@kernel
def locate(points, first, stop, frame, limits, keep, grid, order, places, local, starts):
    """Sort one chunk of points by cell: a stable counting sort.

    ``frame`` (3, 4) maps positions to grid coordinates; they are clamped to ``limits`` (2, 3), and a point beyond
    ``keep`` (2, 3) belongs to no cell.
    """
    cells = grid[0] * grid[1] * grid[2]
    length, count = len(local) // 3, stop - first
    cell_of = np.empty(count + 8)
    q = np.empty(3 * (count + 8))
    piece = np.empty(24)
    clear(starts, 0, cells + 2)
    tail = np.empty(24)  # the last eight points may be fewer: they are read from a copy
    clear(tail, 0, 24)
    for n in range(3 * (count // 8 * 8), 3 * count):
        put(tail, n - 3 * (count // 8 * 8), get(points, 3 * first + n))
    for n in range(0, count, 8):
        x, y, z = load_triples(points, 3 * (first + n)) if n + 8 <= count else load_triples(tail, 0)
        cell, inside = spread(0.0), spread(1.0)
        for axis in range(3):
            value = affine(frame, axis, x, y, z)
            inside = where_between(value, keep[0, axis], keep[1, axis], inside, 0.0)
            value = clamp(value, limits[0, axis], limits[1, axis])
            column = clamp(whole(value), 0.0, grid[axis] - 1.0)
            cell = cell * float(grid[axis]) + column
            store(piece, 8 * axis, value - column)
        store(cell_of, n, where_between(inside, 1.0, 1.0, cell, float(cells)))
        store_triples(q, 3 * n, load(piece, 0), load(piece, 8), load(piece, 16))
    for n in range(count):
        starts[int(get(cell_of, n)) + 1] += 1
    for cell in range(cells + 1):
        starts[cell + 1] += starts[cell]
    place = starts.copy()
    for n in range(count):
        cell = int(get(cell_of, n))
        at = place[cell]
        place[cell] = at + 1
        order[first + at] = first + n
        places[first + n] = at
    for at in range(first, stop):  # gathered, so that what is written to memory is written in sequence
        n = 3 * (get(order, at) - first)
        put(local, at, get(q, n))
        put(local, length + at, get(q, n + 1))
        put(local, 2 * length + at, get(q, n + 2))


@inlined
def tabulate(table, at, basis, t):
    """The four basis functions of eight parameters, from ``table[at]`` on."""
    for b in range(4):
        store(table, at + 8 * b, cubic(basis, b, 4, t))


@inlined
def tabulate_slopes(table, at, basis, t):
    """The derivatives of the four basis functions, likewise."""
    for b in range(4):
        store(table, at + 8 * b, (t * (3.0 * basis[3, b]) + 2.0 * basis[2, b]) * t + basis[1, b])


@inlined
def _corner(cell, grid, stride, shape):
    """Where a cell's first control value stands in the flat lattice."""
    z, rest = cell % grid[2], cell // grid[2]
    y, x = rest % grid[1], rest // grid[1]
    return stride * ((x * shape[1] + y) * shape[2] + z) * 3


@inlined
def _cube(lattice, at, down_x, down_y, table, x, y, z):
    """The sum over 4 x 4 x 4 control values: along z, then y, then x, 84 multiply-adds.

    ``x``, ``y`` and ``z`` say where in the table the factors along each axis begin.
    """
    z0, z1, z2, z3 = load(table, z), load(table, z + 8), load(table, z + 16), load(table, z + 24)
    cube = spread(0.0)
    for i in range(4):
        plane = spread(0.0)
        for j in range(4):
            p = at + i * down_x + j * down_y
            row = z0 * get(lattice, p) + z1 * get(lattice, p + 3) + z2 * get(lattice, p + 6) + z3 * get(lattice, p + 9)
            plane = plane + load(table, y + 8 * j) * row
        cube = cube + load(table, x + 8 * i) * plane
    return cube


@inlined
def _expand(powers, corner, down_x, down_y, basis, half, cell):
    """A cell's cubic polynomials: from powers along z to powers along y, then x, in rows of 16 with 12 in use."""
    for i in range(4):
        for part in range(0, 16, 8):
            row = corner + i * down_x + part
            r0, r1 = load(powers, row), load(powers, row + down_y)
            r2, r3 = load(powers, row + 2 * down_y), load(powers, row + 3 * down_y)
            for q in range(4):
                store(half, 64 * i + 16 * q + part, weighted(basis, 4 * q, 1, r0, r1, r2, r3))
    for at in range(0, 64, 8):
        r0, r1, r2, r3 = load(half, at), load(half, at + 64), load(half, at + 128), load(half, at + 192)
        for p in range(4):
            store(cell, 64 * p + at, weighted(basis, 4 * p, 1, r0, r1, r2, r3))


@inlined
def _polynomials(cell, u, v, w):
    """A cell's three polynomials at eight points, by Horner's rule along z, y, then x: 189 multiply-adds."""
    x, y, z = spread(0.0), spread(0.0), spread(0.0)
    for i in range(192, -64, -64):
        a, b, c = spread(0.0), spread(0.0), spread(0.0)
        for at in range(i + 48, i - 16, -16):
            a = a * v + cubic(cell, at, 1, w)
            b = b * v + cubic(cell, at + 4, 1, w)
            c = c * v + cubic(cell, at + 8, 1, w)
        x, y, z = x * u + a, y * u + b, z * u + c
    return x, y, z


@kernel
def evaluate(first, starts, order, places, local, grid, stride, basis, powers, shape, chosen, base, out):
    """out = base + the tensor product, at one chunk's points in the chosen cells.

    ``powers``, flat, of shape (x, y, cells along z, 3, 4), and four numbers more: the lattice as cubic polynomials
    along z, coefficients of the powers 0 to 3. Where all cells are chosen, points that belong to none get their base.
    """
    length, cells = len(local) // 3, len(starts) - 2
    count, owned = starts[cells + 1], starts[cells]
    moved, half, cubic = np.empty(3 * (count + 8)), np.empty(256), np.empty(256)  # sorted: written in sequence
    down_x, down_y = shape[1] * grid[2] * 12, grid[2] * 12
    for cell in chosen:
        if starts[cell] == starts[cell + 1]:
            continue
        k, rest = cell % grid[2], cell // grid[2]
        corner = ((rest // grid[1] * shape[1] + rest % grid[1]) * stride * grid[2] + k) * 12
        _expand(powers, corner, down_x, down_y, basis, half, cubic)
        for at in range(first + starts[cell], first + starts[cell + 1], 8):
            x, y, z = _polynomials(cubic, load(local, at), load(local, length + at), load(local, 2 * length + at))
            store_triples(moved, 3 * (at - first), x, y, z)
    if len(chosen) < cells:
        for cell in chosen:
            for at in range(starts[cell], starts[cell + 1]):
                n = 3 * get(order, first + at)
                for c in range(3):
                    put(out, n + c, get(base, n + c) + get(moved, 3 * at + c))
        return
    clear(moved, 3 * owned, 3 * count)
    for n in range(first, first + count - 1):  # the fourth number is overwritten by the next point
        add_triple(out, 3 * n, base, 3 * n, moved, 3 * get(places, n))
    last = 3 * (first + count - 1)
    for c in range(3):
        put(out, last + c, get(base, last + c) + get(moved, 3 * get(places, first + count - 1) + c))


@kernel
def differentiate(first, starts, order, local, frame, grid, stride, basis, lattice, shape, linear, out):
    """out (n, 3, 3), flat = ``linear`` (3, 3) + the derivative of the tensor product with respect to position."""
    length, cells = len(local) // 3, len(starts) - 2
    table = np.empty(192)
    scratch = np.empty(72)
    down_x, down_y = shape[1] * shape[2] * 3, shape[2] * 3
    for cell in range(cells):
        corner, stop = _corner(cell, grid, stride, shape), first + starts[cell + 1]
        for at in range(first + starts[cell], stop, 8):
            for axis in range(3):
                tabulate(table, 64 * axis, basis, load(local, axis * length + at))
                tabulate_slopes(table, 64 * axis + 32, basis, load(local, axis * length + at))
            for entry in range(9):
                store(scratch, 8 * entry, spread(get(linear, entry)))
            for axis in range(3):
                x, y, z = 32 * (axis == 0), 64 + 32 * (axis == 1), 128 + 32 * (axis == 2)
                for c in range(3):
                    slope = _cube(lattice, corner + c, down_x, down_y, table, x, y, z)
                    for a in range(3):
                        place = 8 * (3 * c + a)
                        store(scratch, place, load(scratch, place) + slope * get(frame, 4 * axis + a))
            for i in range(min(8, stop - at)):
                n = 9 * get(order, at + i)
                for entry in range(9):
                    put(out, n + entry, get(scratch, 8 * entry + i))
    for at in range(first + starts[cells], first + starts[cells + 1]):
        for entry in range(9):
            put(out, 9 * get(order, at) + entry, get(linear, entry))


@kernel
def gather(first, starts, order, local, grid, stride, basis, shape, values, lattice):
    """Add the transpose of :func:`evaluate` to a lattice: each point's value, spread over its 64 control values."""
    length = len(local) // 3
    sums = np.empty(192 * 8)
    table = np.empty(96)
    here = np.empty(24)
    for cell in range(len(starts) - 2):
        if starts[cell] == starts[cell + 1]:
            continue
        stop = first + starts[cell + 1]
        clear(sums, 0, 192 * 8)
        for at in range(first + starts[cell], stop, 8):
            clear(here, 0, 24)
            for i in range(min(8, stop - at)):
                for c in range(3):
                    put(here, 3 * i + c, get(values, 3 * get(order, at + i) + c))
            value = load_triples(here, 0)
            for axis in range(3):
                tabulate(table, 32 * axis, basis, load(local, axis * length + at))
            for ij in range(16):
                share = load(table, 8 * (ij // 4)) * load(table, 32 + 8 * (ij % 4))
                for k in range(4):
                    for c in range(3):
                        at_sum = 8 * (12 * ij + 3 * k + c)
                        store(sums, at_sum, load(sums, at_sum) + share * load(table, 64 + 8 * k) * value[c])
        corner = _corner(cell, grid, stride, shape)
        for ij in range(16):
            row = corner + ((ij // 4) * shape[1] + ij % 4) * shape[2] * 3
            for entry in range(12):
                lattice[row + entry] += total(load(sums, 8 * (12 * ij + entry)))


@kernel
def column(first, starts, order, local, grid, along_x, along_y, along_z, chosen, at, points, weights):
    """The weights that one control value has at the points of the chosen cells, written from place ``at`` on.

    The points come in ascending order: passing over them is then passing over memory in sequence.

    ``along_x`` (cells + 1, 4) and so on: the coefficients, lowest power first, of the control's basis function in
    each cell of that axis.
    """
    length, count = len(local) // 3, starts[len(starts) - 1]
    piece, reached = np.empty(8), np.full(count, np.nan)  # the weight of each point that is reached
    for cell in chosen:
        k, rest = cell % grid[2], cell // grid[2]
        i, j = rest // grid[1], rest % grid[1]
        stop = first + starts[cell + 1]
        for place in range(first + starts[cell], stop, 8):
            u, v, w = load(local, place), load(local, length + place), load(local, 2 * length + place)
            store(piece, 0, cubic(along_x, 4 * i, 1, u) * cubic(along_y, 4 * j, 1, v) * cubic(along_z, 4 * k, 1, w))
            for lane in range(min(8, stop - place)):
                put(reached, get(order, place + lane) - first, get(piece, lane))
    for n in range(count):
        weight = get(reached, n)
        if not np.isnan(weight):
            points[at] = first + n
            put(weights, at, weight)
            at += 1


@kernel
def shift(first, stop, points, weights, anchors, step, out):
    """out[points] = anchors + weights * step, for one piece of a column."""
    for at in range(first, stop):
        n, weight = 3 * get(points, at), get(weights, at)
        for c in range(3):
            put(out, n + c, get(anchors, 3 * at + c) + weight * step[c])
