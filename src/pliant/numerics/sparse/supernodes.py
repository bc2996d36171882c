"""Kernels that solve with a sparse Cholesky factor kept in dense blocks: eight of its entries at a time.

Neighbouring columns of a factor with the same rows below them are a supernode. Its entries are kept without indices,
so that the factor is read once, in sequence; the rows that it reaches are gathered and scattered once a supernode.
:mod:`pliant.numerics.sparse.elimination` finds them, :mod:`pliant.numerics.sparse.fronts` fills them.

Arguments that the kernels share:

``first``
    (s + 1,) the first column of each supernode.
``rows, row_starts``
    The rows below each supernode's columns, one supernode after another, and where each begins.
``blocks, block_starts``
    The factor: of each supernode its (w, w) unit lower triangle, then column by column what is below.
``x``
    (3 n,) right-hand sides, overwritten with the solution.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel
from pliant.numerics.compute.lanes import get, load, put, spread, store, total


@inlined
def _forward(first, rows, row_starts, blocks, block_starts, x, moved):
    for s in range(len(first) - 1):
        begin, width = first[s], first[s + 1] - first[s]
        at, low, below = block_starts[s], row_starts[s], row_starts[s + 1] - row_starts[s]
        for i in range(1, width):
            a, b, c = get(x, 3 * (begin + i)), get(x, 3 * (begin + i) + 1), get(x, 3 * (begin + i) + 2)
            for j in range(i):
                value, p = get(blocks, at + i * width + j), 3 * (begin + j)
                a, b, c = a - value * get(x, p), b - value * get(x, p + 1), c - value * get(x, p + 2)
            put(x, 3 * (begin + i), a)
            put(x, 3 * (begin + i) + 1, b)
            put(x, 3 * (begin + i) + 2, c)
        at += width * width
        whole = below // 8 * 8
        for k in range(0, whole, 8):
            a, b, c = spread(0.0), spread(0.0), spread(0.0)
            for j in range(width):
                value, p = load(blocks, at + j * below + k), 3 * (begin + j)
                a, b, c = a + value * get(x, p), b + value * get(x, p + 1), c + value * get(x, p + 2)
            store(moved, 0, a)
            store(moved, 8, b)
            store(moved, 16, c)
            for m in range(8):
                p = 3 * get(rows, low + k + m)
                put(x, p, get(x, p) - get(moved, m))
                put(x, p + 1, get(x, p + 1) - get(moved, 8 + m))
                put(x, p + 2, get(x, p + 2) - get(moved, 16 + m))
        for k in range(whole, below):
            q = 3 * get(rows, low + k)
            d, e, f = get(x, q), get(x, q + 1), get(x, q + 2)
            for j in range(width):
                value, p = get(blocks, at + j * below + k), 3 * (begin + j)
                d, e, f = d - value * get(x, p), e - value * get(x, p + 1), f - value * get(x, p + 2)
            put(x, q, d)
            put(x, q + 1, e)
            put(x, q + 2, f)


@inlined
def _backward(first, rows, row_starts, blocks, block_starts, pivots, x, gathered):
    room = len(gathered) // 3
    for s in range(len(first) - 2, -1, -1):
        begin, width = first[s], first[s + 1] - first[s]
        at, low, below = block_starts[s], row_starts[s], row_starts[s + 1] - row_starts[s]
        for k in range(below):
            p = 3 * get(rows, low + k)
            put(gathered, k, get(x, p))
            put(gathered, room + k, get(x, p + 1))
            put(gathered, 2 * room + k, get(x, p + 2))
        whole = below // 8 * 8
        for j in range(width - 1, -1, -1):
            p, column = 3 * (begin + j), at + width * width + j * below
            pivot = get(pivots, begin + j)
            d, e, f = get(x, p) / pivot, get(x, p + 1) / pivot, get(x, p + 2) / pivot
            for i in range(j + 1, width):
                value, q = get(blocks, at + i * width + j), 3 * (begin + i)
                d, e, f = d - value * get(x, q), e - value * get(x, q + 1), f - value * get(x, q + 2)
            if whole:
                a, b, c = spread(0.0), spread(0.0), spread(0.0)
                for k in range(0, whole, 8):
                    value = load(blocks, column + k)
                    a = a + value * load(gathered, k)
                    b = b + value * load(gathered, room + k)
                    c = c + value * load(gathered, 2 * room + k)
                d, e, f = d - total(a), e - total(b), f - total(c)
            for k in range(whole, below):
                value = get(blocks, column + k)
                d = d - value * get(gathered, k)
                e = e - value * get(gathered, room + k)
                f = f - value * get(gathered, 2 * room + k)
            put(x, p, d)
            put(x, p + 1, e)
            put(x, p + 2, f)


@kernel
def solve_three(first, rows, row_starts, blocks, block_starts, pivots, largest, x):
    """Solve L D Lᵀ x = b for three right-hand sides; ``largest`` is the most rows below a supernode."""
    moved, gathered = np.empty(24), np.empty(3 * (largest + 8))
    _forward(first, rows, row_starts, blocks, block_starts, x, moved)
    _backward(first, rows, row_starts, blocks, block_starts, pivots, x, gathered)
