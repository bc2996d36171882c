"""Weights of edges, and the Laplacians that they make.

Everything is built from one object: a symmetric (n, n) sparse array W of non-negative edge weights, zero on its
diagonal. Its Laplacian is L = D - W with D the row sums. Raw cotangents are negative on the obtuse edges of real
meshes, and infinite on degenerate triangles: an energy of squares with such weights has no minimum. Two cures are
offered, clamping and the intrinsic Delaunay triangulation.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, diags_array

Floats = NDArray[np.float64]
Triangles = NDArray[np.int32]

LOWEST, HIGHEST = 1e-4, 1e4
"""Bounds of an edge's cotangent weight; 0.577 belongs to a regular triangulation."""


def cotangent_weights(points: Floats, triangles: Triangles) -> csr_array:
    """Half the cotangents of the angles opposite an edge, summed, and clamped to [1e-4, 1e4] (Pinkall & Polthier 1993).

    Exactly the linear finite elements where no edge is obtuse; a degenerate triangle gives its edges the least
    weight. Edges of three triangles or more sum over all.
    """
    corners = triangles[:, [[1, 2], [2, 0], [0, 1]]]
    one = points[corners[:, :, 0]] - points[triangles]
    two = points[corners[:, :, 1]] - points[triangles]
    dot = np.einsum("tki,tki->tk", one, two)
    area = np.linalg.norm(np.cross(one[:, 0], two[:, 0]), axis=1)[:, None]
    size = np.maximum((one**2).sum(axis=2), (two**2).sum(axis=2)).max(axis=1, keepdims=True)
    half = np.divide(dot, 2 * area, out=np.zeros_like(dot), where=area > 1e-12 * size)
    weights = _symmetric(corners.reshape(-1, 2), half.reshape(-1), len(points))
    weights.data = np.clip(weights.data, LOWEST, HIGHEST)
    return weights


def intrinsic_weights(points: Floats, triangles: Triangles) -> csr_array:
    """Cotangents of the intrinsic Delaunay triangulation of a tufted cover (Sharp & Crane 2020): never negative.

    Its edges need not be edges of the mesh. Non-manifold meshes have one too.
    """
    import robust_laplacian

    used, sound = _compact(triangles)
    if not len(sound):
        return csr_array((len(points), len(points)))
    stiffness, _ = robust_laplacian.mesh_laplacian(np.ascontiguousarray(points[used]), sound)
    entries = coo_array(stiffness)
    off = (entries.row != entries.col) & (entries.data < 0)
    row, column = used[entries.row[off]], used[entries.col[off]]
    weights = np.clip(-entries.data[off], LOWEST, HIGHEST)
    full = csr_array((weights, (row, column)), shape=(len(points), len(points)))
    return csr_array((full + full.T) / 2)


def uniform_weights(points: Floats, triangles: Triangles) -> csr_array:
    """One for each edge: connectivity alone."""
    corners = triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2)
    weights = _symmetric(corners, np.ones(len(corners)), len(points))
    weights.data[:] = 1.0
    return weights


def mean_value_weights(points: Floats, triangles: Triangles) -> csr_array:
    """Floater's mean-value weights (2003), tan(α/2) + tan(β/2) over the edge's length: positive, not symmetric."""
    following, before = np.roll(triangles, -1, axis=1), np.roll(triangles, 1, axis=1)
    one, two = points[following] - points[triangles], points[before] - points[triangles]
    a, b = np.linalg.norm(one, axis=2), np.linalg.norm(two, axis=2)
    sine = np.linalg.norm(np.cross(one, two), axis=2)
    denominator = a * b + np.einsum("tki,tki->tk", one, two)
    tangent = np.divide(sine, denominator, out=np.full_like(sine, HIGHEST), where=denominator > sine / HIGHEST)
    least = 1e-12 * max(float(a.max(initial=0.0)), 1e-300)
    row = np.concatenate([triangles.reshape(-1)] * 2)
    column = np.concatenate([following.reshape(-1), before.reshape(-1)])
    tangents = np.maximum(tangent, LOWEST)
    data = np.concatenate([(tangents / np.maximum(x, least)).reshape(-1) for x in (a, b)])
    off = row != column
    return csr_array((data[off], (row[off], column[off])), shape=(len(points), len(points)))


WEIGHTS: dict[str, Callable[[Floats, Triangles], csr_array]] = {
    "cotangent": cotangent_weights,
    "intrinsic": intrinsic_weights,
    "mean value": mean_value_weights,
    "uniform": uniform_weights,
}
"""Edge weights by name."""


def laplacian(weights: csr_array) -> csr_array:
    """L = D - W: rows sum to zero."""
    return csr_array(diags_array(row_sums(weights)) - weights)


def normalized(weights: csr_array) -> csr_array:
    """I - D^-1 W: what a vertex is away from the weighted mean of its neighbours. An empty row stays empty."""
    sums = row_sums(weights)
    inverse = np.divide(1.0, sums, out=np.zeros_like(sums), where=sums > 0)
    return csr_array(diags_array((sums > 0).astype(np.float64)) - diags_array(inverse) @ weights)


def row_sums(weights: csr_array) -> Floats:
    """(n,) the sum of each row."""
    return np.asarray(weights.sum(axis=1), np.float64).reshape(-1)


def masses(points: Floats, triangles: Triangles) -> Floats:
    """(n,) a third of the area around each vertex: the lumped mass matrix's diagonal.

    A vertex without area gets a millionth of the mean, so that one may divide by it.
    """
    one, two = (points[triangles[:, i]] - points[triangles[:, 0]] for i in (1, 2))
    area = np.linalg.norm(np.cross(one, two), axis=1) / 2
    result = np.bincount(triangles.reshape(-1), weights=np.repeat(area / 3, 3), minlength=len(points))
    mean = float(result.mean()) if len(result) else 0.0
    return np.maximum(result, 1e-6 * mean if mean > 0 else 1.0)


def _symmetric(edges: Any, values: Floats, count: int) -> csr_array:
    """(count, count) sums over (k, 2) edges, both ways, none from a vertex to itself."""
    off = edges[:, 0] != edges[:, 1]
    row, column = edges[off].T
    matrix = csr_array(
        (np.tile(values[off], 2), (np.concatenate([row, column]), np.concatenate([column, row]))), shape=(count, count)
    )
    matrix.sum_duplicates()
    return matrix


def _compact(triangles: Triangles) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The vertices that proper triangles use, and those triangles in terms of them."""
    a, b, c = triangles.T
    proper = triangles[(a != b) & (b != c) & (c != a)]
    used, inverse = np.unique(proper, return_inverse=True)
    return used.astype(np.int64), inverse.reshape(-1, 3).astype(np.int64)
