"""The closest point of a triangle mesh, among triangles that face the same way."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_CANDIDATES = 24  # triangles with the nearest centroids, of which one holds the closest point


class FacingTriangles:
    """Triangles to be searched for points.

    Parameters
    ----------
    points, triangles
        (n, 3) and (t, 3), t >= 1.
    """

    def __init__(self, points: Floats, triangles: NDArray[np.int32]) -> None:
        from scipy.spatial import cKDTree

        self._corners = points[triangles]
        self._normals = unit_normals(points, triangles)
        self._tree = cKDTree(self._corners.mean(axis=1))
        self._count = min(_CANDIDATES, len(triangles))

    def closest(self, queries: Floats, normals: Floats) -> tuple[Floats, Integers]:
        """(k, 3) the closest points to (k, 3) queries on triangles less than 90° from (k, 3) normals, and which.

        Where none of the nearest triangles faces that way, the triangle is -1 and the point the query.
        """
        _, near = self._tree.query(queries, self._count, workers=1)
        near = near.reshape(len(queries), -1)
        facing = np.einsum("kmi,ki->km", self._normals[near], normals) > 0
        points = project(np.repeat(queries, near.shape[1], axis=0), self._corners[near.reshape(-1)])
        points = points.reshape(*near.shape, 3)
        square = ((points - queries[:, None]) ** 2).sum(axis=2)
        best = np.where(facing, square, np.inf).argmin(axis=1)
        rows = np.arange(len(queries))
        found = facing[rows, best]
        return np.where(found[:, None], points[rows, best], queries), np.where(found, near[rows, best], -1)


def unit_normals(points: Floats, triangles: NDArray[np.int32]) -> Floats:
    """(t, 3) unit normals; zero where a triangle has no area."""
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    result: Floats = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)
    return result


def project(queries: Floats, corners: Floats) -> Floats:
    """(k, 3) the closest points to (k, 3) queries on (k, 3, 3) triangles: of the plane, where inside, or of a side."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    u, v, w = b - a, c - a, queries - a
    uu, uv, vv = _dot(u, u), _dot(u, v), _dot(v, v)
    wu, wv = _dot(w, u), _dot(w, v)
    area = uu * vv - uv * uv
    flat = area <= 1e-14 * uu * vv
    safe = np.where(flat, 1.0, area)
    s, t = (vv * wu - uv * wv) / safe, (uu * wv - uv * wu) / safe
    inside = ~flat & (s >= 0) & (t >= 0) & (s + t <= 1)
    sides = np.stack([_on_side(queries, p, q) for p, q in ((a, b), (b, c), (c, a))])
    nearest = ((sides - queries) ** 2).sum(axis=2).argmin(axis=0)
    found: Floats = np.where(
        inside[:, None], a + s[:, None] * u + t[:, None] * v, sides[nearest, np.arange(len(queries))]
    )
    return found


def _on_side(queries: Floats, start: Floats, end: Floats) -> Floats:
    along = end - start
    square = _dot(along, along)
    part = np.divide(_dot(queries - start, along), square, out=np.zeros_like(square), where=square > 0)
    return start + np.clip(part, 0.0, 1.0)[:, None] * along


def _dot(one: Floats, two: Floats) -> Floats:
    return np.asarray(np.einsum("ki,ki->k", one, two))
