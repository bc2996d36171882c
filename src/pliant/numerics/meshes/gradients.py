"""How triangles deform: the gradient of a map on each triangle of a mesh, as a sparse matrix."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

Floats = NDArray[np.float64]
Triangles = NDArray[np.int32]

_FLAT = 1e-8  # of the longest side: a triangle less high than this has no direction


def sound(points: Floats, triangles: NDArray[np.integer]) -> NDArray[np.bool_]:
    """(t,) which triangles have an area to speak of."""
    sides = points[triangles[:, [1, 2, 0]]] - points[triangles]
    longest = (sides**2).sum(axis=2).max(axis=1)
    return np.asarray(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) > _FLAT * longest)


def frames(points: Floats, triangles: Triangles) -> Floats:
    """(t, 3, 3) columns: two sides of each triangle, and its normal scaled by the root of its length (Sumner 2004).

    The identity for a triangle that is not :func:`sound`.
    """
    a, b, c = (points[triangles[:, i]] for i in range(3))
    u, v = b - a, c - a
    normal = np.cross(u, v)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    fourth = np.divide(normal, np.sqrt(length), out=np.zeros_like(normal), where=length > 0)
    result = np.stack([u, v, fourth], axis=2)
    result[~sound(points, triangles)] = np.eye(3)
    return result


class DeformationGradients:
    """S = Ṽ V⁻¹ with the frames V before and Ṽ after (Sumner & Popović 2004, eq. 3), for many poses.

    Parameters
    ----------
    points, triangles
        (n, 3) at rest, and (t, 3).
    """

    def __init__(self, points: Floats, triangles: Triangles) -> None:
        self._usable, self._triangles = sound(points, triangles), triangles
        self._inverse = np.linalg.inv(frames(points, triangles))

    def __call__(self, moved: Floats) -> Floats:
        """(t, 3, 3) for (n, 3) positions; the identity where a triangle has no area, at rest or moved."""
        result = frames(moved, self._triangles) @ self._inverse
        result[~(self._usable & sound(moved, self._triangles))] = np.eye(3)
        return result


def plane_gradients(points: Floats, triangles: Triangles) -> csr_array:
    """(3 t, n) the gradient of a piecewise linear function in each triangle's plane; zero where not :func:`sound`."""
    inverse = np.asarray(np.linalg.inv(frames(points, triangles)), np.float64)
    return _sparse(inverse[:, :2], triangles, points, len(points))


def full_gradients(points: Floats, triangles: Triangles) -> csr_array:
    """(3 t, n + t) gradients by three corners and a fourth vertex of each triangle, at the tip of its normal."""
    inverse = np.asarray(np.linalg.inv(frames(points, triangles)), np.float64)
    fourth = len(points) + np.arange(len(triangles))
    return _sparse(inverse, np.column_stack([triangles, fourth]), points, len(points) + len(triangles))


def _sparse(rows: Floats, vertices: NDArray[np.integer], points: Floats, columns: int) -> csr_array:
    """Coefficients of the other vertices are rows of V⁻¹; that of the first makes the sum vanish."""
    count = len(vertices)
    factors = (
        np.concatenate([-rows.sum(axis=1, keepdims=True), rows], axis=1) * sound(points, vertices[:, :3])[:, None, None]
    )
    row = np.broadcast_to(3 * np.arange(count)[:, None, None] + np.arange(3), factors.shape)
    column = np.broadcast_to(vertices[:, :, None], factors.shape)
    return csr_array((factors.reshape(-1), (row.reshape(-1), column.reshape(-1))), shape=(3 * count, columns))
