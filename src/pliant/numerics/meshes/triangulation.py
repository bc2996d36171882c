"""Polygons cut into triangles, concave ones without leaving the polygon."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.ragged import Ragged

Points = NDArray[np.float64]


def triangulate(points: Points, polygons: Ragged) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Cut each polygon into triangles, in polygon order and orientation.

    Convex polygons become fans, concave quadrangles are cut at their reflex corner, and other concave polygons
    lose one ear after another. A polygon with fewer than three corners gives no triangle.

    Parameters
    ----------
    points
        (n, 3) positions.
    polygons
        (f,) rows of vertex indices.

    Returns
    -------
    triangles
        (t, 3) positions *in* ``polygons.flat``, so that data kept per corner can follow.
    face
        (t,) the polygon that each triangle was cut from.
    """
    if polygons.uniform == 3:
        count = len(polygons)
        return np.arange(3 * count, dtype=np.int32).reshape(count, 3), np.arange(count, dtype=np.int32)
    pieces = np.maximum(polygons.lengths - 2, 0)
    face = np.repeat(np.arange(len(polygons), dtype=np.int32), pieces)
    step = np.arange(len(face)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    first = polygons.offsets[face]
    triangles = np.stack([first, first + step + 1, first + step + 2], axis=1).astype(np.int32)
    start = np.concatenate([[0], np.cumsum(pieces)])
    for polygon in _concave(points, polygons):
        corners = _ears(points[polygons[polygon]])
        triangles[start[polygon] : start[polygon + 1]] = corners + polygons.offsets[polygon]
    return triangles, face


def polygon_normals(points: Points, polygons: Ragged) -> Points:
    """(f, 3) Newell's area vectors: twice the area along the normal, exact also for bent and concave polygons."""
    if not len(polygons.flat):
        return np.zeros((len(polygons), 3))
    following = np.arange(1, len(polygons.flat) + 1)
    filled = polygons.lengths > 0
    following[polygons.offsets[1:][filled] - 1] = polygons.offsets[:-1][filled]
    origin = points[polygons.flat[np.minimum(polygons.offsets[:-1], len(polygons.flat) - 1)]][polygons.row_of]
    here = points[polygons.flat] - origin
    sums = np.zeros((len(polygons), 3))
    sums[filled] = np.add.reduceat(np.cross(here, here[following]), polygons.offsets[:-1][filled], axis=0)
    return sums


def _concave(points: Points, polygons: Ragged) -> NDArray[np.int64]:
    """The polygons of four or more corners that turn the wrong way somewhere."""
    large = np.repeat(polygons.lengths > 3, polygons.lengths)
    at = np.flatnonzero(large)
    if not len(at):
        return np.empty(0, np.int64)
    face = polygons.row_of[at]
    first, count = polygons.offsets[face], polygons.lengths[face]
    here = points[polygons.flat[at]]
    before = points[polygons.flat[first + (at - first - 1) % count]]
    after = points[polygons.flat[first + (at - first + 1) % count]]
    turn = np.einsum("ij,ij->i", np.cross(here - before, after - here), polygon_normals(points, polygons)[face])
    return np.unique(face[turn < 0]).astype(np.int64)


def _ears(corners: Points) -> NDArray[np.int32]:
    """(k - 2, 3) triangles of one simple polygon by ear clipping (Meisters 1975), in the plane it fills best."""
    normal = np.cross(corners - corners[0], np.roll(corners, -1, axis=0) - corners[0]).sum(axis=0)
    drop = int(np.argmax(np.abs(normal)))
    flat = np.delete(corners, drop, axis=1)
    if (normal[drop] < 0) != (drop == 1):  # dropping y mirrors the plane
        flat = flat[:, ::-1]
    left = list(range(len(corners)))
    triangles = []
    while len(left) > 3:
        at = next((i for i in range(len(left)) if _is_ear(flat, left, i)), None)
        if at is None:  # crossing edges: no ear is clean, the flattest corner does the least harm
            at = max(range(len(left)), key=lambda i: _turn(flat, left, i))
        triangles.append((left[at - 1], left[at], left[(at + 1) % len(left)]))
        del left[at]
    triangles.append((left[0], left[1], left[2]))
    return np.array(triangles, np.int32)


def _turn(flat: Points, left: list[int], at: int) -> float:
    a, b, c = flat[left[at - 1]], flat[left[at]], flat[left[(at + 1) % len(left)]]
    return float((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]))


def _is_ear(flat: Points, left: list[int], at: int) -> bool:
    """Whether a corner turns left and its triangle holds none of the polygon's other corners."""
    if _turn(flat, left, at) <= 0:
        return False
    trio = (left[at - 1], left[at], left[(at + 1) % len(left)])
    a, b, c = (flat[i] for i in trio)
    others = flat[[i for i in left if i not in trio]]
    others = others[~((others == a) | (others == b) | (others == c)).all(axis=1)]
    inside = np.ones(len(others), bool)
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= (q[0] - p[0]) * (others[:, 1] - p[1]) - (q[1] - p[1]) * (others[:, 0] - p[0]) >= 0
    return not bool(inside.any())
