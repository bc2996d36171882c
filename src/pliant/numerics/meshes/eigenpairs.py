"""The lowest vibrations of a surface: L u = λ M u with M diagonal.

With y = M^(1/2) u the problem is an ordinary symmetric one, and no inner product needs M. A block Lanczos method on
its shifted inverse (Grimes, Lewis & Simon 1994) solves for three vectors at a time, as the factor reads its entries
once for three. The basis is kept orthogonal throughout: it is small.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.sparse import csc_array, diags_array

from pliant.errors import NotConverged
from pliant.numerics.compute.one_thread import one_blas_thread
from pliant.numerics.sparse.sparse_cholesky import Cholesky

Floats = NDArray[np.float64]

_BLOCK = 3  # right-hand sides that the factor solves for at once
_DENSE = 400  # unknowns: up to here a dense solver is as fast


def lowest_eigenpairs(stiffness: Any, mass: Floats, count: int, *, tolerance: float = 1e-9) -> tuple[Floats, Floats]:
    """The ``count`` lowest eigenvalues and eigenvectors of L u = λ M u.

    Parameters
    ----------
    stiffness
        (n, n) sparse, symmetric, positive semi-definite.
    mass
        (n,) the positive diagonal of M.
    count
        How many; at most n.
    tolerance
        Largest residual |L u - λ M u| in the norm of M^-1 that counts as solved, relative to the largest eigenvalue
        wanted, for u of length one.

    Returns
    -------
    values
        (count,) ascending.
    vectors
        (n, count) with U^T M U = I; the entry largest in size of each is positive.

    Raises
    ------
    NotConverged
        The residual stays above the tolerance.
    """
    with one_blas_thread():
        return _lowest(stiffness, mass, count, tolerance)


def _lowest(stiffness: Any, mass: Floats, count: int, tolerance: float) -> tuple[Floats, Floats]:
    root = np.sqrt(mass)
    scaled = csc_array(diags_array(1 / root) @ stiffness @ diags_array(1 / root))
    size = len(mass)
    if size <= max(_DENSE, 4 * count):
        every, dense = np.linalg.eigh(scaled.toarray())
        return _finished(every[:count], dense[:, :count], root)
    shift = 1e-2 * float(scaled.diagonal().mean()) * count / size  # far below the eigenvalues wanted (Weyl's law)
    krylov = _Krylov(Cholesky(scaled + diags_array(np.full(size, shift))), min(size, 40 * count + 200))
    while krylov.extend():
        if krylov.width < 2 * count or (krylov.width % (4 * _BLOCK) and krylov.width + _BLOCK <= krylov.room):
            continue
        inverse, found = krylov.largest(count, tolerance)
        if found is None:
            continue
        values = 1 / inverse - shift
        residual = np.linalg.norm(scaled @ found - found * values, axis=0)
        if residual.max() <= tolerance * values[-1]:
            return _finished(values, found, root)
    raise NotConverged(f"{count} eigenpairs of {size:,} unknowns were not found; ask for fewer")


class _Krylov:
    """An orthonormal basis Q of a block Krylov space of A^-1, and T = Q^T A^-1 Q."""

    def __init__(self, factor: Cholesky, room: int) -> None:
        self._factor, self.width, self.room = factor, 0, room
        self._basis = np.empty((factor.size, room), order="F")
        self._projected = np.zeros((room, room))
        self._next = np.linalg.qr(np.random.default_rng(1).normal(size=(factor.size, _BLOCK)))[0]
        self._coupling = np.zeros((_BLOCK, _BLOCK))

    def extend(self) -> bool:
        """Take in one more block; False where there is no room."""
        begin, end = self.width, self.width + _BLOCK
        if end > self.room:
            return False
        self._basis[:, begin:end] = self._next
        self.width = end
        basis, block = self._basis[:, :end], self._factor.solve(self._next)
        for _ in range(2):  # orthogonal to working precision: twice is enough (Kahan and Parlett)
            share = basis.T @ block
            block -= basis @ share
            self._projected[:end, begin:end] += share
        self._next, self._coupling = np.linalg.qr(block)
        return True

    def largest(self, count: int, tolerance: float) -> tuple[Floats, Floats | None]:
        """The largest eigenvalues of A^-1, descending, and their vectors, once the space holds them well enough."""
        projected = self._projected[: self.width, : self.width]
        values, rotation = eigh(projected, lower=False)
        values, rotation = values[::-1][:count], rotation[:, ::-1][:, :count]
        residual = np.linalg.norm(self._coupling @ rotation[-_BLOCK:], axis=0)
        if (residual > tolerance * values).any():
            return values, None
        return values, self._basis[:, : self.width] @ rotation


def _finished(values: Floats, vectors: Floats, root: Floats) -> tuple[Floats, Floats]:
    vectors = vectors / root[:, None]
    largest = np.abs(vectors).argmax(axis=0)
    vectors *= np.sign(vectors[largest, np.arange(vectors.shape[1])])
    return np.maximum(values, 0.0), vectors
