"""Weights as they are kept: dense in double or in single precision, or sparse."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, vstack

from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.compute.one_thread import one_blas_thread

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_ROWS = 4096  # rows that are multiplied at once, in double precision whatever they are kept in


class WeightTable:
    """(n, k) weights.

    Parameters
    ----------
    matrix
        Dense, float64 or float32, or sparse.
    """

    def __init__(self, matrix: NDArray[np.floating] | csr_array) -> None:
        self.matrix = matrix

    @property
    def shape(self) -> tuple[int, int]:
        """Number of points and of values."""
        rows, columns = self.matrix.shape
        return rows, columns

    def apply(self, values: Floats) -> Floats:
        """(n, c) what (k, c) values become."""
        if isinstance(self.matrix, csr_array):
            return np.asarray(self.matrix @ values)
        matrix, out = self.matrix, np.empty((len(self.matrix), values.shape[1]))

        def work(first: int, stop: int) -> None:
            np.matmul(matrix[first:stop].astype(np.float64, copy=False), values, out=out[first:stop])

        with one_blas_thread():
            for_chunks(work, len(matrix), _ROWS)
        return out

    def transposed(self, values: Floats) -> Floats:
        """(k, c) the transpose of :meth:`apply`."""
        if isinstance(self.matrix, csr_array):
            return np.asarray(self.matrix.T @ values)
        total = np.zeros((self.matrix.shape[1], values.shape[1]))
        with one_blas_thread():
            for first in range(0, len(self.matrix), _ROWS):
                block = self.matrix[first : first + _ROWS].astype(np.float64, copy=False)
                total += block.T @ values[first : first + _ROWS]
        return total

    def columns(self, chosen: Indices) -> Floats:
        """(n, c) some columns, dense, in double precision."""
        picked = self.matrix[:, chosen]
        return np.ascontiguousarray(picked.toarray() if isinstance(picked, csr_array) else picked, np.float64)


class TableMaker:
    """Collects the rows of a table.

    Parameters
    ----------
    shape
        Number of points and of values.
    precision
        ``"float64"`` or ``"float32"``.
    threshold
        Weights smaller than this are dropped, and the table is sparse; 0 = dense.
    """

    def __init__(self, shape: tuple[int, int], precision: str, threshold: float) -> None:
        self._shape, self._type, self._threshold = shape, np.dtype(precision), threshold
        self._dense = np.empty(shape if not threshold else (0, 0), self._type)
        self._pieces: dict[int, csr_array] = {}

    def put(self, first: int, rows: Floats, *, even: bool) -> None:
        """Rows from a place on; where ``even``, what dropping takes from their sums is given back to the others."""
        if not self._threshold:
            self._dense[first : first + len(rows)] = rows
            return
        kept = np.where(np.abs(rows) >= self._threshold, rows, 0.0)
        if even and len(rows):
            left = kept.sum(axis=1)
            safe = np.abs(left) > 0.5
            kept *= np.where(safe, rows.sum(axis=1) / np.where(safe, left, 1.0), 1.0)[:, None]
        self._pieces[first] = csr_array(kept.astype(self._type))

    def table(self) -> WeightTable:
        """What was collected."""
        if not self._threshold:
            return WeightTable(self._dense)
        empty = csr_array((0, self._shape[1]), dtype=self._type)
        return WeightTable(csr_array(vstack([empty, *(self._pieces[at] for at in sorted(self._pieces))])))


def filled(
    count: int, piece: int, rows: Callable[[int, int], list[Floats | None]], makers: list[TableMaker | None]
) -> list[WeightTable | None]:
    """Tables of ``count`` rows, made in pieces on all processors; the first maker's rows add up to one."""

    def work(first: int, stop: int) -> None:
        for number, (maker, made) in enumerate(zip(makers, rows(first, stop), strict=True)):
            if maker is not None and made is not None:
                maker.put(first, made, even=number == 0)

    for_chunks(work, count, piece)
    return [None if maker is None else maker.table() for maker in makers]
