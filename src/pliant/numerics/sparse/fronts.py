"""Kernels that factor a sparse matrix supernode by supernode (the multifrontal method, Duff & Reid 1983).

A supernode's columns gather the matrix's entries and the updates that its children hand on; they are eliminated,
straight in the block that solving reads, and what they subtract from the rows below is the update handed on to the
parent. Nearly all the arithmetic is one product of dense matrices a supernode, in tiles of 16 rows by 4 columns.

Arguments that the kernels share, besides those of :mod:`pliant.numerics.sparse.elimination_tree` and
:mod:`pliant.numerics.sparse.supernodes`:

``updates, starts, lead``
    The updates, of which the lower triangles count; where each supernode's begins and how far apart its columns are.
``scaled, step``
    The columns of a supernode below its triangle, L D, and how far apart they are.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel
from pliant.numerics.compute.lanes import get, load, put, spread, store

_NEGLIGIBLE = 1e-13  # a pivot this much smaller than its diagonal entry is rounding


@inlined
def apart(below):
    """How far apart columns of ``below`` rows are: a tile's rows more, and an odd number of cache lines."""
    return ((below + 7) // 8 + 1 | 1) * 8


@inlined
def _subtract(target, at, lead, scaled, step, blocks, low, across, down, begin, end, depth):
    """Rows ``begin`` to ``end`` of four columns of ``target`` less rows of ``scaled`` times four rows of L."""
    for row in range(begin, end, 16):
        i, p, q = at + row, row, low
        j, k, m = i + lead, i + 2 * lead, i + 3 * lead
        a, b, c, d = load(target, i), load(target, j), load(target, k), load(target, m)
        e, f, g, h = load(target, i + 8), load(target, j + 8), load(target, k + 8), load(target, m + 8)
        for _ in range(depth):
            x, y = load(scaled, p), load(scaled, p + 8)
            s, t, u, v = get(blocks, q), get(blocks, q + down), get(blocks, q + 2 * down), get(blocks, q + 3 * down)
            a, b, c, d = a - x * s, b - x * t, c - x * u, d - x * v
            e, f, g, h = e - y * s, f - y * t, g - y * u, h - y * v
            p, q = p + step, q + across
        store(target, i, a)
        store(target, i + 8, e)
        store(target, j, b)
        store(target, j + 8, f)
        store(target, k, c)
        store(target, k + 8, g)
        store(target, m, d)
        store(target, m + 8, h)


@inlined
def _factor_triangle(blocks, at, width, pivots, begin):
    """The (w, w) triangle as L D Lᵀ; the first column whose pivot is lost to rounding, or -1."""
    for i in range(width):
        diagonal = get(blocks, at + i * width + i)
        left = diagonal
        for j in range(i):
            value = get(blocks, at + i * width + j)
            for k in range(j):
                value -= get(blocks, at + i * width + k) * get(blocks, at + j * width + k)
            put(blocks, at + i * width + j, value)
        for j in range(i):
            value = get(blocks, at + i * width + j)
            part = value / get(pivots, begin + j)
            left -= value * part
            put(blocks, at + i * width + j, part)
        if not left > _NEGLIGIBLE * abs(get(pivots, begin + i)):
            return i
        put(pivots, begin + i, left)
    return -1


@inlined
def _eliminate(blocks, at, width, below, pivots, begin, scaled, updates, start, lead):
    """Factor the columns of one supernode and subtract from its update; the first bad column, or -1."""
    bad = _factor_triangle(blocks, at, width, pivots, begin)
    if bad >= 0 or below == 0:
        return bad
    low, step = at + width * width, apart(below)
    for j in range(width):
        for k in range(below):
            put(scaled, j * step + k, get(blocks, low + j * below + k))
    for tile in range(0, width, 4):
        _subtract(scaled, tile * step, step, scaled, step, blocks, at + tile * width, 1, width, 0, below, tile)
        for j in range(tile + 1, min(tile + 4, width)):
            for i in range(tile, j):
                value = spread(get(blocks, at + j * width + i))
                for k in range(0, below, 8):
                    store(scaled, j * step + k, load(scaled, j * step + k) - value * load(scaled, i * step + k))
    for j in range(width):
        inverse = 1 / get(pivots, begin + j)
        for k in range(below):
            put(blocks, low + j * below + k, get(scaled, j * step + k) * inverse)
    for tile in range(0, below, 4):
        _subtract(
            updates, start + tile * lead, lead, scaled, step, blocks, low + tile, below, 1, tile // 8 * 8, below, width
        )
    return -1


@inlined
def _add(array, index, value):
    put(array, index, get(array, index) + value)


@inlined
def _gather(pointers, indices, values, order, place, begin, width, below, blocks, at, local):
    """Add the matrix's entries to a supernode's columns; ``local`` is the row of its block that each place is."""
    for j in range(begin, begin + width):
        column = at + width * width + (j - begin) * below - width
        for p in range(pointers[order[j]], pointers[order[j] + 1]):
            i = get(place, get(indices, p))
            if i >= begin + width:
                _add(blocks, column + get(local, i), get(values, p))
            elif i >= j:
                _add(blocks, at + (i - begin) * width + j - begin, get(values, p))


@inlined
def _take(child, s, first, rows, row_starts, blocks, at, local, updates, starts, lead, single):
    """Add a child's update to a supernode's columns and, but where the child's is taken over, to its update."""
    width, below = first[s + 1] - first[s], row_starts[s + 1] - row_starts[s]
    low, size = row_starts[child], row_starts[child + 1] - row_starts[child]
    inner = 0
    while inner < size and rows[low + inner] < first[s + 1]:
        inner += 1
    for j in range(inner):
        column, source = local[rows[low + j]], starts[child] + j * lead[child]
        for i in range(j, inner):
            _add(blocks, at + get(local, get(rows, low + i)) * width + column, get(updates, source + i))
        target = at + width * width + column * below - width
        for i in range(inner, size):
            _add(blocks, target + get(local, get(rows, low + i)), get(updates, source + i))
    if single:
        return
    for j in range(inner, size):
        source = starts[child] + j * lead[child]
        target = starts[s] + (local[rows[low + j]] - width) * lead[s] - width
        for i in range(j, size):
            _add(updates, target + get(local, get(rows, low + i)), get(updates, source + i))


@kernel
def factor(
    pointers, indices, values, order, place, first, rows, row_starts, block_starts, child_starts, children, single,
    starts, lead, updates, blocks, pivots,
):  # fmt: skip
    """Factor into ``blocks`` and ``pivots``, which hold zeros and the diagonal; the first bad place, or -1."""
    local = np.empty(len(order), np.int64)
    largest, widest = 0, 0
    for s in range(len(first) - 1):
        largest = max(largest, row_starts[s + 1] - row_starts[s])
        widest = max(widest, first[s + 1] - first[s])
    scaled = np.empty(apart(largest) * (widest + 4))
    for s in range(len(first) - 1):
        begin, width, at = first[s], first[s + 1] - first[s], block_starts[s]
        below = row_starts[s + 1] - row_starts[s]
        for j in range(width):
            local[begin + j] = j
        for k in range(below):
            local[rows[row_starts[s] + k]] = width + k
        if not single[s]:
            for j in range(below):
                for k in range(j, below):
                    put(updates, starts[s] + j * lead[s] + k, 0.0)
        _gather(pointers, indices, values, order, place, begin, width, below, blocks, at, local)
        for c in range(child_starts[s], child_starts[s + 1]):
            _take(children[c], s, first, rows, row_starts, blocks, at, local, updates, starts, lead, single[s])
        bad = _eliminate(blocks, at, width, below, pivots, begin, scaled, updates, starts[s], lead[s])
        if bad >= 0:
            return begin + bad
    return -1
