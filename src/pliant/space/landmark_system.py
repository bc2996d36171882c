"""The linear system of a landmark warp: from displacements of landmarks to coefficients of functions of space."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidDeformer
from pliant.mesh import Points
from pliant.numerics.compute.one_thread import one_blas_thread
from pliant.numerics.maps.radial import RadialBasis

Floats = NDArray[np.float64]


class LandmarkSystem:
    """From displacements of landmarks to coefficients of a warp, and back; factorised once.

    Parameters
    ----------
    basis
        The radial function around the landmarks.
    polynomials
        (4, d) polynomials that the warp reproduces: coefficients of x, y, z and 1.
    regularization
        Added to the diagonal of the radial part.

    Raises
    ------
    InvalidDeformer
        Landmarks too close together to be told apart.
    """

    def __init__(self, basis: RadialBasis, polynomials: Floats, regularization: float) -> None:
        self.basis, self._polynomials = basis, polynomials
        self.count, degree = len(basis.centers), polynomials.shape[1]
        block = np.hstack([basis.centers, np.ones((self.count, 1))]) @ polynomials
        matrix = np.zeros((self.count + degree,) * 2)
        matrix[: self.count, : self.count] = basis.matrix() + regularization * np.eye(self.count)
        matrix[: self.count, self.count :], matrix[self.count :, : self.count] = block, block.T
        self._factors = _factorised(matrix)

    def coefficients(self, displacements: Floats) -> tuple[Floats, Floats]:
        """(k, 3) weights of the radial functions and the (3, 4) affine part."""
        solved = self._solved(displacements, self.count)
        return np.ascontiguousarray(solved[: self.count]), (self._polynomials @ solved[self.count :]).T.copy()

    def displace(self, points: Points, displacements: Floats, base: Points, out: Points) -> None:
        """Out = base + the warp's displacement at the points."""
        weights, affine = self.coefficients(displacements)
        self.basis.sum(points, weights, affine, base, out)

    def jacobian(self, points: Points, displacements: Floats) -> Floats:
        """(n, 3, 3) at the points."""
        weights, affine = self.coefficients(displacements)
        return self.basis.slopes(points, weights, np.eye(3) + affine[:, :3])

    def transpose(self, points: Points, values: Floats) -> Floats:
        """(k, 3) the transpose of :meth:`displace` applied to (n, 3) values."""
        moments = np.vstack([points.T @ values, values.sum(axis=0)])
        gathered = np.vstack([self.basis.gather(points, values), self._polynomials.T @ moments])
        return self._solved(gathered, len(gathered))[: self.count]  # the system is symmetric

    def _solved(self, values: Floats, rows: int) -> Floats:
        """The system's solution for (rows, 3) values, and zeros below them."""
        from scipy.linalg import lu_solve

        factors, pivots = self._factors
        right = np.zeros((len(factors), 3))
        right[:rows] = values
        with one_blas_thread():
            return np.asarray(lu_solve((factors, pivots.copy()), right))  # LAPACK's wrapper counts pivots up and down


def _factorised(matrix: Floats) -> Any:
    """LU factors: one factorisation serves every move of the landmarks."""
    from scipy.linalg import LinAlgWarning, lu_factor

    with warnings.catch_warnings(), one_blas_thread():
        warnings.simplefilter("error", LinAlgWarning)
        try:
            return lu_factor(matrix)
        except LinAlgWarning as error:
            raise InvalidDeformer("the landmarks' system is singular: some lie too close together") from error
