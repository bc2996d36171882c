"""Pairs of triangles that cut one another: an edge of one passes through the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_FOLDED = 1e-9  # neighbours whose normals are opposite up to this lie on one another


def self_crossings(points: Floats, triangles: NDArray[np.integer]) -> Indices:
    """(k, 2) pairs of triangles of one surface that cut one another; sharing corners or edges is no cut."""
    pairs = _pairs(points, triangles, points, triangles, itself=True)
    folded = _folded(points, np.asarray(triangles, np.int64))
    return np.unique(np.concatenate([pairs, folded]), axis=0) if len(pairs) + len(folded) else pairs


def crossings(points: Floats, triangles: NDArray[np.integer], others: Floats, other: NDArray[np.integer]) -> Indices:
    """(k, 2) pairs of a triangle of one surface and one of another that cut one another."""
    return _pairs(points, triangles, others, other, itself=False)


def _pairs(
    points: Floats, triangles: NDArray[np.integer], others: Floats, other: NDArray[np.integer], *, itself: bool
) -> Indices:
    from pliant.numerics.meshes.crossing_kernels import cutting_pairs

    if not len(triangles) or not len(other):
        return np.empty((0, 2), np.int64)
    second = others[other]
    order = np.argsort(second.min(axis=1)[:, 0])
    second = np.ascontiguousarray(second[order])
    low, high = second.min(axis=1), second.max(axis=1)
    first = np.ascontiguousarray(points[triangles])
    one, two = np.ascontiguousarray(triangles, np.int64), np.ascontiguousarray(other[order], np.int64)
    width = float((high[:, 0] - low[:, 0]).max())
    found = np.empty((4096, 2), np.int64)
    count = cutting_pairs(first, one, second, two, low, high, width, itself, found)
    if count > len(found):
        found = np.empty((count, 2), np.int64)
        cutting_pairs(first, one, second, two, low, high, width, itself, found)
    pairs = found[:count]
    pairs[:, 1] = order[pairs[:, 1]]
    return pairs[pairs[:, 0] < pairs[:, 1]] if itself else pairs


def _folded(points: Floats, triangles: Indices) -> Indices:
    """Pairs that share an edge and lie on one another."""
    half = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    order = np.lexsort(np.sort(half, axis=1).T)
    same = (np.sort(half[order], axis=1)[1:] == np.sort(half[order], axis=1)[:-1]).all(axis=1)
    a, b = order[:-1][same] // 3, order[1:][same] // 3
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    np.divide(normals, length, out=normals, where=length > 0)
    opposite = np.einsum("ki,ki->k", normals[a], normals[b]) < -1 + _FOLDED
    return np.sort(np.stack([a[opposite], b[opposite]], axis=1), axis=1)
