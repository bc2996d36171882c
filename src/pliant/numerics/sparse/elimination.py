"""How a sparse matrix will be factored: all that its pattern decides, found once for matrices of the same pattern."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.sparse import elimination_tree as trees

Integers = NDArray[np.int64]

_WIDEST = 48  # columns of a supernode: its part of x stays in the first-level cache
_FEW = 8  # columns that come together whatever zeros that stores
_ZEROS = 0.05  # the share of a supernode's entries that may be zeros


class Elimination:
    """The elimination order and the shape of the factor, of which all arrays are what the kernels take.

    Parameters
    ----------
    matrix
        (n, n) sparse by columns, of symmetric pattern.
    order
        (n,) an elimination order: place → unknown. Subtrees are gathered, which changes nothing of the fill.
    """

    def __init__(self, matrix: Any, order: Integers) -> None:
        self.pointers = matrix.indptr.astype(np.int64, copy=False)
        self.indices = matrix.indices.astype(np.int32, copy=False)
        place = _inverse(order)
        parent, postorder = trees.find_tree(self.pointers, self.indices, order, place)
        moved = _inverse(postorder)
        self.order, self.place = order[postorder], moved[place]
        parent = np.where(parent < 0, -1, moved[parent])[postorder]
        self._find_rows(parent)
        self._place_updates()

    def fits(self, matrix: Any) -> bool:
        """Whether a matrix has the very pattern of the first."""
        return np.array_equal(matrix.indptr, self.pointers) and np.array_equal(matrix.indices, self.indices)

    def _find_rows(self, parent: Integers) -> None:
        pattern = self.pointers, self.indices, self.order, self.place
        first = np.empty(len(parent) + 1, np.int64)
        runs, count = trees.join_columns(*pattern, parent, _FEW, _ZEROS, first)
        first = first[: runs + 1].copy()
        last = first[1:] - 1
        row_starts = _sums(count[last])
        above = np.searchsorted(first, parent[last], "right") - 1
        rows = trees.find_rows(*pattern, first, above, row_starts)

        width = np.diff(first)
        pieces = -(-width // _WIDEST)
        run = np.repeat(np.arange(len(width)), pieces)
        nth = np.arange(len(run)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
        self.first = np.append(first[run] + nth * width[run] // pieces[run], len(parent))
        self.below = first[run + 1] - self.first[1:] + count[last][run]
        self.row_starts = _sums(self.below)
        owner = np.repeat(np.arange(len(run)), self.below)
        kth = np.arange(len(owner)) - self.row_starts[owner]
        inner = first[run + 1] - self.first[1:]  # the run's later columns are below its earlier ones
        old = np.maximum(kth - inner[owner], 0) + row_starts[run[owner]]
        self.rows = np.where(kth < inner[owner], self.first[owner + 1] + kth, np.append(rows, 0)[old]).astype(np.int32)
        self.width = np.diff(self.first)
        self.largest = int(self.below.max(initial=0))
        self.block_starts = _sums(self.width * (self.width + self.below))

    def _place_updates(self) -> None:
        supernodes = len(self.below)
        above = np.full(supernodes, -1)
        some = self.below > 0
        above[some] = np.searchsorted(self.first, self.rows[self.row_starts[:-1][some]], "right") - 1
        self.children = np.flatnonzero(some)[np.argsort(above[some], kind="stable")]
        many = np.bincount(above[some], minlength=supernodes)
        self.child_starts = _sums(many)
        only = self.children[np.minimum(self.child_starts[:-1], len(self.children) - 1)] if some.any() else above
        self.single = (many == 1) & (self.below[only] == self.width + self.below)
        self.lead = ((self.below + 7) // 8 + 1 | 1) * 8  # rows of a tile more, and an odd number of cache lines
        self.starts = np.empty(supernodes, np.int64)
        columns = np.where(some, self.below + 4, 0)
        self.room = 16 + trees.place_updates(above, self.single, self.width, self.lead, columns, self.starts)


def _inverse(order: Integers) -> Integers:
    result = np.empty(len(order), np.int64)
    result[order] = np.arange(len(order))
    return result


def _sums(counts: Integers) -> Integers:
    return np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
