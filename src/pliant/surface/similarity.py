"""Local similarities as linear functions of the vertices that they carry (Sorkine et al. 2004, eqs. 6 to 10).

Around vertex i the displacements of its neighbourhood are fitted by σ p + h × p, p being measured from the
neighbourhood's mean: the linearised similarities. σ and h are linear in the displacements,

    σ = Σ p·u / Σ |p|²,    h = (Σ |p|² - p p^T)⁻¹ Σ p × u,

and so is what they add to δ: σ δ + h × δ.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, eye_array, kron

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


def similarity_equations(
    points: Floats, operator: csr_array, rows: Integers, graph: csr_array, unknown: Integers
) -> csr_array:
    """(3 r, 3 m) what the displacements of (m,) unknown vertices add to L x - T(x) δ at (r,) vertices.

    Parameters
    ----------
    points
        (n, 3) at rest.
    operator
        (r, n) L at those vertices.
    rows
        (r,) which they are.
    graph
        (n, n) who is a neighbour.
    unknown
        (m,) the vertices that move.
    """
    around = csr_array((graph + eye_array(graph.shape[0]))[rows])
    owner, vertex = np.repeat(np.arange(len(rows)), np.diff(around.indptr)), around.indices
    count = np.bincount(owner)
    mean = np.stack([np.bincount(owner, weights=points[vertex, i]) for i in range(3)], axis=1) / count[:, None]
    p = points[vertex] - mean[owner]
    square = np.bincount(owner, weights=(p**2).sum(axis=1))
    products = np.stack([np.bincount(owner, weights=p[:, i] * p[:, j]) for i in range(3) for j in range(3)], axis=1)
    inertia = square[:, None, None] * np.eye(3) - products.reshape(-1, 3, 3)
    turning = np.linalg.pinv(inertia, rcond=1e-8, hermitian=True)  # neighbours in a line tell nothing about one turn
    delta = np.asarray(operator @ points)
    share = np.divide(delta, square[:, None], out=np.zeros_like(delta), where=square[:, None] > 0)
    blocks = share[owner][:, :, None] * p[:, None, :] - (_cross(delta) @ turning)[owner] @ _cross(p)
    place = np.full(len(points), -1)
    place[unknown] = np.arange(len(unknown))
    keep = place[vertex] >= 0
    i, j = np.meshgrid(np.arange(3), np.arange(3), indexing="ij")
    row = 3 * owner[keep, None, None] + i
    column = 3 * place[vertex[keep]][:, None, None] + j
    fitted = csr_array(
        (blocks[keep].reshape(-1), (row.reshape(-1), column.reshape(-1))), shape=(3 * len(rows), 3 * len(unknown))
    )
    return csr_array(kron(operator[:, unknown], eye_array(3), format="csr") - fitted)


def _cross(vectors: Floats) -> Floats:
    """(k, 3, 3) the matrices of v × ."""
    x, y, z = vectors.T
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
