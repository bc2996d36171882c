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
from pliant.numerics.sparse_cholesky import Cholesky

Floats = NDArray[np.float64]

_BLOCK = 3  # right-hand sides that the factor solves for at once


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
    root = np.sqrt(mass)
    scaled = csc_array(diags_array(1 / root) @ stiffness @ diags_array(1 / root))
    size = len(mass)
    if size <= max(60, 4 * count):
        values, vectors = np.linalg.eigh(scaled.toarray())
        return _finished(values[:count], vectors[:, :count], root)
    shift = 1e-2 * float(scaled.diagonal().mean()) * count / size  # between the eigenvalues wanted, Weyl's law says
    factor = Cholesky(scaled + diags_array(np.full(size, shift)))
    basis, products = np.empty((size, 0)), np.empty((size, 0))
    block = np.random.default_rng(1).normal(size=(size, _BLOCK))
    while basis.shape[1] < min(size, 40 * count + 200):
        block = _orthogonal_to(basis, block)
        basis = np.hstack([basis, block])
        block = factor.solve(block)
        products = np.hstack([products, block])
        if basis.shape[1] >= 2 * count and basis.shape[1] % (2 * _BLOCK) == 0:
            projected = basis.T @ products
            inverse, rotation = eigh((projected + projected.T) / 2)
            inverse, rotation = inverse[::-1][:count], rotation[:, ::-1][:, :count]
            values = 1 / inverse - shift
            vectors = basis @ rotation
            if (np.linalg.norm(products @ rotation - vectors * inverse, axis=0) / inverse**2).max() > 1e3 * values[-1]:
                continue
            residual = np.linalg.norm(scaled @ vectors - vectors * values, axis=0)
            if residual.max() <= tolerance * values[-1]:
                return _finished(values, vectors, root)
    raise NotConverged(f"{count} eigenpairs of {size:,} unknowns were not found; ask for fewer")


def _orthogonal_to(basis: Floats, block: Floats) -> Floats:
    """The block, orthonormal and orthogonal to the basis: twice is enough (Kahan & Parlett)."""
    for _ in range(2):
        block = block - basis @ (basis.T @ block)
        block = np.linalg.qr(block)[0]
    return block


def _finished(values: Floats, vectors: Floats, root: Floats) -> tuple[Floats, Floats]:
    vectors = vectors / root[:, None]
    largest = np.abs(vectors).argmax(axis=0)
    vectors *= np.sign(vectors[largest, np.arange(vectors.shape[1])])
    return np.maximum(values, 0.0), vectors
