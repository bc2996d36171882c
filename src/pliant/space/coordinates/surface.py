"""The surface of a cage at rest, as the kernels of coordinates see it: triangles, edges that they share, planes."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points
from pliant.numerics.meshes.closest_surface import Closest, TriangleSearch

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class CageSurface:
    """A closed triangle surface, in a unit in which its diagonal is one.

    Parameters
    ----------
    points, triangles
        (m, 3) positions, and (t, 3) vertices, counter-clockwise from outside.
    """

    def __init__(self, points: Points, triangles: NDArray[np.integer]) -> None:
        low, high = points.min(axis=0), points.max(axis=0)
        self.scale = float(np.linalg.norm(high - low))
        self.center = (low + high) / 2
        self.points = np.ascontiguousarray((points - self.center) / self.scale)
        self.triangles = np.ascontiguousarray(triangles, np.int64)
        around = self.triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2)  # the edge opposite each corner
        self.edges, place = np.unique(np.sort(around, axis=1), axis=0, return_inverse=True)
        backwards = around[:, 0] > around[:, 1]
        self.sides = np.ascontiguousarray((2 * place.reshape(-1) + backwards).reshape(-1, 3))
        self.lines = (self.points[self.edges[:, 1]] - self.points[self.edges[:, 0]]).reshape(-1)

    def scaled(self, points: Points) -> Floats:
        """(n, 3) points in the surface's own unit."""
        return np.ascontiguousarray((points - self.center) / self.scale)

    @cached_property
    def duals(self) -> Floats:
        """(3 m,) vectors, adding up to zero, whose products with the vertices add up to the identity."""
        used = np.zeros(len(self.points), bool)
        used[self.triangles] = True
        arms = np.where(used[:, None], self.points - self.points[used].mean(axis=0), 0.0)
        return np.ascontiguousarray(arms @ np.linalg.inv(arms.T @ arms)).reshape(-1)

    @cached_property
    def corners(self) -> Floats:
        """(t, 3, 3) the triangles' corners."""
        return self.points[self.triangles]

    @cached_property
    def normals(self) -> Floats:
        """(t, 3) outward normals, twice as long as the triangles' areas."""
        a, b, c = self.corners.transpose(1, 0, 2)
        return np.cross(b - a, c - a)

    @cached_property
    def planes(self) -> Floats:
        """(t, 16) unit normal n; m_i = e_i x n / l_i for the edge from corner i; l / 2A opposite each corner; 2A."""
        double = np.linalg.norm(self.normals, axis=1)
        unit = self.normals / double[:, None]
        lines = np.roll(self.corners, -1, axis=1) - self.corners
        lengths = np.linalg.norm(lines, axis=2)
        outwards = np.cross(lines, unit[:, None]) / lengths[..., None]
        opposite = np.roll(lengths, -1, axis=1) / double[:, None]
        parts = [unit, outwards.reshape(-1, 9), opposite, double[:, None]]
        return np.ascontiguousarray(np.concatenate(parts, axis=1))

    @cached_property
    def gradients(self) -> Floats:
        """(t, 3, 3) the gradient of each corner's barycentric coordinate."""
        outwards = self.planes[:, 3:12].reshape(-1, 3, 3)
        return -np.roll(outwards, -1, axis=1) * self.planes[:, 12:15, None]

    @cached_property
    def _search(self) -> TriangleSearch:
        return TriangleSearch(self.points, self.triangles)

    def closest(self, points: Floats) -> Closest:
        """The closest points of the surface, in its own unit."""
        return self._search.query(points)

    def exits(self, points: Floats, found: Closest) -> Integers:
        """(k,) for points outside, of the triangles that hold the closest point, the one that faces them most."""
        used = found.weights > 1e-12
        corners = self.triangles[found.triangles]
        major = corners[np.arange(len(corners)), found.weights.argmax(axis=1)]
        around = self._triangles_at[major]
        holds = np.ones(around.shape, bool)
        for k in range(3):
            has = (self.triangles[around] == corners[:, None, None, k]).any(axis=2)
            holds &= has | ~used[:, None, k]
        facing = np.einsum("kfi,ki->kf", self.planes[around, :3], points - found.points)
        best = np.where(holds, facing, -np.inf).argmax(axis=1)
        return np.asarray(around[np.arange(len(best)), best])

    @cached_property
    def _triangles_at(self) -> Integers:
        """(p, f) the triangles at each vertex, the first one repeated to fill rows."""
        order = np.argsort(self.triangles.reshape(-1), kind="stable")
        counts = np.bincount(self.triangles.reshape(-1), minlength=len(self.points))
        starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
        place = np.arange(counts.max())
        inside = np.where(place < counts[:, None], starts[:, None] + place, np.minimum(starts, len(order) - 1)[:, None])
        return np.asarray(order[inside] // 3)

    def __getstate__(self) -> dict[str, object]:
        return {name: value for name, value in self.__dict__.items() if name != "_search"}
