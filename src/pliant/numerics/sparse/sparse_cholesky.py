"""Sparse Cholesky: factor once, solve for many right-hand sides.

The order of elimination (:mod:`pliant.numerics.sparse.fill_reducing`) and the matrix's pattern give the shape of the
factor (:mod:`pliant.numerics.sparse.elimination`), which is computed in dense blocks
(:mod:`pliant.numerics.sparse.fronts`) that solving reads in sequence (:mod:`pliant.numerics.sparse.supernodes`).
Nothing holds the GIL, and the factor pickles.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array

from pliant.errors import SingularSystem
from pliant.numerics.sparse.elimination import Elimination
from pliant.numerics.sparse.fill_reducing import minimum_degree, nested_dissection

Floats = NDArray[np.float64]

_OVERREAD = 256  # entries behind the last block that kernels may read, and never use


class Cholesky:
    """A factored symmetric positive definite matrix. Immutable, thread-safe, and it pickles.

    Parameters
    ----------
    matrix
        (n, n) sparse, symmetric: both triangles are given.
    elimination
        That of a matrix of the same pattern, from :attr:`elimination`; None = find one.

    Raises
    ------
    SingularSystem
        The matrix is not positive definite.
    """

    def __init__(self, matrix: Any, elimination: Elimination | None = None) -> None:
        matrix = _mirrored(csc_array(matrix))
        self.size: int = matrix.shape[0]
        if elimination is None or not elimination.fits(matrix):
            order = nested_dissection(matrix)
            elimination = Elimination(matrix, minimum_degree(matrix) if order is None else order)
        self.elimination = elimination
        self._factor(matrix)

    def refactored(self, matrix: Any) -> Cholesky:
        """Another matrix: where its pattern is the same, all that the pattern decides is kept."""
        return Cholesky(matrix, self.elimination)

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
        from pliant.numerics.sparse import supernodes

        if not right.size:
            return np.zeros(right.shape)
        shape = self.elimination
        columns = right.reshape(self.size, -1)
        result = np.empty(columns.shape)
        x = np.zeros((self.size, 3))
        for begin in range(0, columns.shape[1], 3):
            part = columns[:, begin : begin + 3]
            x[:, : part.shape[1]] = np.take(part, shape.order, axis=0)
            supernodes.solve_three(
                shape.first, shape.rows, shape.row_starts, self._blocks, shape.block_starts, self._pivots,
                shape.largest, x.reshape(-1),
            )  # fmt: skip
            result[:, begin : begin + 3] = np.take(x, shape.place, axis=0)[:, : part.shape[1]]
        return result.reshape(right.shape)

    def _factor(self, matrix: Any) -> None:
        from pliant.numerics.sparse import fronts

        if not np.isfinite(matrix.data).all():
            raise SingularSystem("the matrix to factor holds numbers that are not finite")
        shape = self.elimination
        self._blocks = np.zeros(shape.block_starts[-1] + _OVERREAD)
        self._pivots = matrix.diagonal()[shape.order].astype(np.float64)
        bad = fronts.factor(
            shape.pointers, shape.indices, matrix.data.astype(np.float64, copy=False), shape.order, shape.place,
            shape.first, shape.rows, shape.row_starts, shape.block_starts, shape.child_starts, shape.children,
            shape.single, shape.starts, shape.lead, np.empty(shape.room), self._blocks, self._pivots,
        )  # fmt: skip
        if bad >= 0:
            raise SingularSystem(
                f"the matrix of {self.size:,} unknowns is not positive definite at unknown {shape.order[bad]}: "
                "constrain more of them"
            )


def _mirrored(matrix: csc_array) -> csc_array:
    """A symmetric matrix with sorted columns; where rounding left an entry without its mirror image, the mean."""
    turned = csc_array(matrix.T)  # columns come out sorted
    matrix = csc_array(turned.T)
    if np.array_equal(matrix.indptr, turned.indptr) and np.array_equal(matrix.indices, turned.indices):
        return matrix
    return csc_array((matrix + turned) / 2)
