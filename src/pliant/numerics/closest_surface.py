"""Closest points on triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.chunks import for_chunks

Floats = NDArray[np.float64]
Integers = NDArray[np.integer]

_FIRST = 12  # triangles looked at first, by their centres


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

        self._corners = np.ascontiguousarray(points[triangles])
        centers = self._corners.mean(axis=1)
        self._reach = float(np.sqrt(((self._corners - centers[:, None]) ** 2).sum(axis=2).max()))
        self._tree = cKDTree(centers)

    def query(self, points: Floats, *, exact: bool = True) -> Closest:
        """Closest points.

        Parameters
        ----------
        points
            (m, 3).
        exact
            Look on until no triangle farther off can be closer; else the triangles with the 12 nearest centres must
            do, which is enough where triangles are much of one size.
        """
        found = Closest(np.empty((len(points), 3)), np.empty(len(points), np.int64), np.empty((len(points), 3)))
        left, count = np.arange(len(points)), min(_FIRST, len(self._corners))
        while len(left):
            far, candidates = self._tree.query(points[left], k=count)
            far, candidates = far.reshape(len(left), -1), candidates.reshape(len(left), -1)
            distance = self._nearest(points[left], candidates, left, found)
            if not exact or count == len(self._corners):
                break
            left = left[far[:, -1] < distance + self._reach]
            count = min(4 * count, len(self._corners))
        return found

    def _nearest(self, points: Floats, candidates: NDArray[np.int64], rows: Integers, found: Closest) -> Floats:
        """Fill in some rows; their distances."""
        from pliant.numerics.closest_kernels import nearest_of

        chosen, weights, distance = np.empty(len(points), np.int64), np.empty((len(points), 3)), np.empty(len(points))
        queries, listed = np.ascontiguousarray(points), np.ascontiguousarray(candidates)
        for_chunks(
            lambda start, stop: nearest_of(queries, start, stop, self._corners, listed, chosen, weights, distance),
            len(points),
            4096,
        )
        found.triangles[rows], found.weights[rows] = chosen, weights
        found.points[rows] = np.einsum("mc,mcd->md", weights, self._corners[chosen])
        return np.asarray(np.sqrt(distance))
