"""Sparse Cholesky: factor once, solve for many right-hand sides.

SuperLU in its symmetric mode factors, in the order of METIS where pymetis is installed and of minimum degree
elsewhere. The factor is then kept in dense blocks of our own (:mod:`pliant.numerics.supernodes`): solving is
several times faster, does not hold the GIL, and the factor pickles.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array

from pliant.errors import SingularSystem
from pliant.numerics.fill_reducing import nested_dissection
from pliant.numerics.one_thread import one_blas_thread

Floats = NDArray[np.float64]

_WIDEST = 48  # columns of a block: its part of x stays in the first-level cache
_NEGLIGIBLE = 1e-13  # a pivot this much smaller than its diagonal entry is rounding


class Cholesky:
    """A factored symmetric positive definite matrix. Immutable, thread-safe, and it pickles.

    Parameters
    ----------
    matrix
        (n, n) sparse, symmetric: both triangles are given.
    order
        (n,) an elimination order found earlier, from :attr:`order`; None = find one.

    Raises
    ------
    SingularSystem
        The matrix is not positive definite.
    """

    def __init__(self, matrix: Any, order: NDArray[np.int64] | None = None) -> None:
        matrix = csc_array(matrix)
        self.size: int = matrix.shape[0]
        self._order_given = nested_dissection(matrix) if order is None else order
        if self.size:
            self._factor(matrix)

    @property
    def order(self) -> NDArray[np.int64] | None:
        """(n,) the elimination order, for another matrix of the same pattern; None where SuperLU found its own."""
        return self._order_given

    def refactored(self, matrix: Any) -> Cholesky:
        """Another matrix of the same pattern: the search for an order is saved."""
        return Cholesky(matrix, self._order_given)

    def solve(self, right: Floats) -> Floats:
        """Solve A x = b.

        Parameters
        ----------
        right
            (n,) or (n, k) right-hand sides.

        Returns
        -------
        ndarray
            Shaped as ``right``.
        """
        from pliant.numerics import supernodes

        if not right.size:
            return np.zeros(right.shape)
        columns = right.reshape(self.size, -1)
        result = np.empty(columns.shape)
        x = np.zeros((self.size, 3))
        for begin in range(0, columns.shape[1], 3):
            part = columns[:, begin : begin + 3]
            x[:, : part.shape[1]] = np.take(part, self._places, axis=0)
            supernodes.solve_three(
                self._first, self._rows, self._row_starts, self._blocks, self._block_starts, self._pivots,
                self._largest, x.reshape(-1),
            )  # fmt: skip
            result[:, begin : begin + 3] = np.take(x, self._back, axis=0)[:, : part.shape[1]]
        return result.reshape(right.shape)

    def _factor(self, matrix: Any) -> None:
        from scipy.sparse.linalg import splu

        order = self._order_given
        ordered = matrix if order is None else csc_array(matrix[order][:, order])
        if not np.isfinite(ordered.data).all():
            raise SingularSystem("the matrix to factor holds numbers that are not finite")
        try:
            with one_blas_thread():
                factors = splu(
                    ordered,
                    permc_spec="MMD_AT_PLUS_A" if order is None else "NATURAL",
                    diag_pivot_thresh=0.0,
                    options={"SymmetricMode": True},
                )
        except RuntimeError as error:
            raise SingularSystem(f"the matrix of {self.size:,} unknowns is singular: constrain more of them") from error
        pivots = np.asarray(factors.U.diagonal(), np.float64)
        places = np.argsort(factors.perm_c)
        diagonal = ordered.diagonal()[places]
        weak = np.flatnonzero(~(pivots > _NEGLIGIBLE * np.abs(diagonal)))
        if len(weak) or not np.array_equal(factors.perm_c, factors.perm_r):
            found = int(places[weak[0]] if len(weak) else 0)
            unknown = found if order is None else int(order[found])
            raise SingularSystem(
                f"the matrix of {self.size:,} unknowns is not positive definite at unknown {unknown}: "
                "constrain more of them"
            )
        self._pivots = pivots
        self._places = places if order is None else order[places]
        self._back = np.argsort(self._places)
        self._keep(factors.L)

    def _keep(self, lower: Any) -> None:
        """Cut L, of unit diagonal, into dense blocks."""
        from pliant.numerics import supernodes

        lower = csc_array(lower)
        lower.sort_indices()
        rest = np.ones(lower.nnz, bool)
        rest[lower.indptr[:-1]] = False  # the diagonal stands first
        pointers = (lower.indptr - np.arange(self.size + 1)).astype(np.int64)
        indices, values = lower.indices[rest].astype(np.int32), lower.data[rest]
        first = np.empty(self.size + 1, np.int64)
        count = supernodes.find_supernodes(pointers, indices, _WIDEST, first)
        self._first = first[: count + 1].copy()
        width, below = np.diff(self._first), np.diff(pointers)[self._first[1:] - 1]
        self._row_starts = np.concatenate([[0], np.cumsum(below)])
        self._block_starts = np.concatenate([[0], np.cumsum(width * (width + below))])
        self._rows, self._blocks = np.empty(self._row_starts[-1], np.int32), np.zeros(self._block_starts[-1])
        self._largest = int(below.max())
        supernodes.fill_blocks(
            pointers, indices, values, self._first, self._rows, self._row_starts, self._blocks, self._block_starts
        )
