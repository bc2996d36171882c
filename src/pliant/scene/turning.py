"""How a surface has turned at its vertices: the rotation that fits the edges around each of them best."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points, PolygonMesh
from pliant.numerics.rigid.rotations import nearest_rotations

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_BIAS = 1e-12  # towards no rotation, where a vertex's edges leave it open


def turned(mesh: PolygonMesh, points: Points, vertices: Integers) -> Floats:
    """(k, 3, 3) how the mesh has turned around some of its vertices.

    Parameters
    ----------
    mesh
        At rest.
    points
        (n, 3) where its vertices are now.
    vertices
        (k,).
    """
    neighbors = mesh.neighbors
    counts = neighbors.lengths[vertices]
    owner = np.repeat(np.arange(len(vertices)), counts)
    first = np.repeat(neighbors.offsets[vertices] - np.concatenate([[0], np.cumsum(counts)[:-1]]), counts)
    other = neighbors.flat[first + np.arange(len(owner))] if len(owner) else np.empty(0, np.int64)
    here = vertices[owner]
    before, after = mesh.points[other] - mesh.points[here], points[other] - points[here]
    outer = after[:, :, None] * before[:, None, :]
    columns = [np.bincount(owner, weights=column, minlength=len(vertices)) for column in outer.reshape(-1, 9).T]
    spread = np.stack(columns, axis=1).reshape(-1, 3, 3)
    size = np.abs(spread).sum(axis=(1, 2))
    return nearest_rotations(spread + _BIAS * size[:, None, None] * np.eye(3))
