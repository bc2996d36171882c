"""Closest points on triangles: exact, by a tree of boxes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.compute.chunks import for_chunks

Floats = NDArray[np.float64]
Integers = NDArray[np.integer]

_LEAF = 2  # triangles, at least, in a box that is not divided


@dataclass(frozen=True)
class Closest:
    """For each query: the point, its triangle, and its barycentric weights there."""

    points: Floats  # (m, 3)
    triangles: NDArray[np.int64]  # (m,)
    weights: Floats  # (m, 3)


class TriangleSearch:
    """Finds closest points on a surface.

    Parameters
    ----------
    points, triangles
        (n, 3) positions, and (t, 3) vertex indices, t > 0.
    """

    def __init__(self, points: Floats, triangles: Integers) -> None:
        from scipy.spatial import cKDTree

        corners = points[triangles]
        self._order = cKDTree(corners.mean(axis=1), leafsize=_LEAF).indices  # neighbours in space lie together
        self._place = np.empty(len(corners), np.int64)
        self._place[self._order] = np.arange(len(corners))
        self._corners = np.ascontiguousarray(corners[self._order])
        leaves = 1 << max(0, (len(corners) // _LEAF).bit_length() - 1)
        self._bounds = np.arange(leaves + 1) * len(corners) // leaves
        self._boxes = _boxes(self._corners, self._bounds)

    def query(self, points: Floats, near: Integers | None = None) -> Closest:
        """The closest points to (m, 3) points; ``near`` (m,) are triangles to begin with, at best the right ones."""
        from pliant.numerics.meshes.closest_kernels import nearest_in

        queries, count = np.ascontiguousarray(points), len(points)
        chosen = np.full(count, -1) if near is None else self._place[near]
        weights, distance = np.empty((count, 3)), np.empty(count)
        for_chunks(
            lambda start, stop: nearest_in(
                queries, start, stop, self._corners, self._bounds, self._boxes, chosen, weights, distance
            ),
            count,
            512,
        )
        corners = self._corners[chosen]
        places = weights[:, :1] * corners[:, 0] + weights[:, 1:2] * corners[:, 1] + weights[:, 2:] * corners[:, 2]
        return Closest(places, np.asarray(self._order[chosen], np.int64), weights)


def _boxes(corners: Floats, bounds: Integers) -> Floats:
    """(2 l, 6) the least and the greatest coordinates in each node of a complete binary tree; node 0 is not used."""
    leaves = len(bounds) - 1
    boxes = np.zeros((2 * leaves, 6))
    boxes[leaves:, :3] = np.minimum.reduceat(corners.min(axis=1), bounds[:-1])
    boxes[leaves:, 3:] = np.maximum.reduceat(corners.max(axis=1), bounds[:-1])
    while leaves > 1:
        below, leaves = boxes[leaves : 2 * leaves], leaves // 2
        boxes[leaves : 2 * leaves, :3] = np.minimum(below[::2, :3], below[1::2, :3])
        boxes[leaves : 2 * leaves, 3:] = np.maximum(below[::2, 3:], below[1::2, 3:])
    return boxes
