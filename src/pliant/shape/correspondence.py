"""Which points of a target the points of a shape belong to: the closest ones, where they can be believed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidTarget
from pliant.mesh import PolygonMesh
from pliant.numerics.meshes.closest_surface import Closest, TriangleSearch
from pliant.numerics.ragged import Ragged

Floats = NDArray[np.float64]
Booleans = NDArray[np.bool_]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Correspondences:
    """What the points of a shape belong to.

    Parameters
    ----------
    places, normals
        (m, 3) the closest points of the target, and the unit normals there; None where it has no surface.
    good
        (m,) whether they can be believed.
    triangles
        (m,) in which triangles they are; None likewise.
    """

    places: Floats
    normals: Floats | None
    good: Booleans
    triangles: Integers | None


class Target:
    """A mesh, or bare points, to look for closest points on.

    Parameters
    ----------
    mesh
        Any topology; without faces, its points.
    angle
        Normals that differ by more, in radians, do not correspond.
    """

    def __init__(self, mesh: PolygonMesh, angle: float) -> None:
        if not len(mesh.points):
            raise InvalidTarget("the target has no points: there is nothing to fit to")
        self.mesh, self._least = mesh, float(np.cos(angle))

    def closest(self, points: Floats) -> Floats:
        """(m, 3) the closest points."""
        return self._query(points)[0]

    def correspondences(self, points: Floats, normals: Floats | None, near: Integers | None = None) -> Correspondences:
        """The closest points, and whether they can be believed.

        Those on the border of an open target are not: what lies beyond it is not in the target. Nor are those whose
        normal disagrees. The search is faster where ``near`` (m,) names triangles that are not far.
        """
        places, found = self._query(points, near)
        good = np.ones(len(points), bool)
        if found is None:
            return Correspondences(places, None, good, None)
        corners = self.mesh.triangles[found.triangles]
        if self._open.any():
            good &= ~((found.weights * ~self._open[corners]).sum(axis=1) < 1e-6)
        if normals is not None:
            smooth = np.einsum("mc,mcd->md", found.weights, self._smooth[corners])  # at a corner no one side counts
            length = np.linalg.norm(smooth, axis=1)
            good &= np.einsum("mi,mi->m", normals, smooth) >= self._least * length - 1e-12
        return Correspondences(places, self._normals[found.triangles], good, found.triangles)

    def _query(self, points: Floats, near: Integers | None = None) -> tuple[Floats, Closest | None]:
        if len(self.mesh.triangles):
            found = self._search.query(points, near)
            return found.points, found
        return self.mesh.points[self._tree.query(points)[1]], None

    @cached_property
    def _search(self) -> TriangleSearch:
        return TriangleSearch(self.mesh.points, self.mesh.triangles)

    @cached_property
    def _tree(self) -> Any:
        from scipy.spatial import cKDTree

        return cKDTree(self.mesh.points)

    @cached_property
    def _normals(self) -> Floats:
        return triangle_normals(self.mesh.points, self.mesh.triangles)

    @cached_property
    def _smooth(self) -> Floats:
        return vertex_normals(self.mesh.points, self.mesh.triangles)

    @cached_property
    def _open(self) -> Booleans:
        """(n,) vertices on a border; vertices at one place count as one, as in files that repeat them."""
        points, faces = self.mesh.points, self.mesh.triangles
        same = _places(points)
        sides = Ragged.of(same[faces])
        edges = np.stack([sides.flat, np.roll(sides.flat.reshape(-1, 3), -1, axis=1).reshape(-1)], axis=1)
        unique, count = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
        border = np.zeros(len(points), bool)
        border[unique[count == 1].reshape(-1)] = True
        return np.asarray(border[same])


def _places(points: Floats) -> NDArray[np.int64]:
    """(n,) one number for all points at one place."""
    order = np.lexsort(points.T)
    new = (np.diff(points[order], axis=0, prepend=points[order[:1]]) != 0).any(axis=1)
    same = np.empty(len(points), np.int64)
    same[order] = np.cumsum(new)
    return same


def triangle_normals(points: Floats, triangles: NDArray[np.int32]) -> Floats:
    """(t, 3) unit normals; zero where a triangle has no area."""
    a, b, c = points[triangles[:, 0]], points[triangles[:, 1]], points[triangles[:, 2]]
    normals = cross(b - a, c - a)
    length = np.sqrt(np.einsum("ti,ti->t", normals, normals))[:, None]
    return np.asarray(np.divide(normals, length, out=np.zeros_like(normals), where=length > 0))


def vertex_normals(points: Floats, triangles: NDArray[np.int32]) -> Floats:
    """(n, 3) unit normals, weighted by area; zero where no triangle defines one."""
    from pliant.numerics.meshes.closest_kernels import add_normals

    sums = np.zeros_like(points)
    add_normals(np.ascontiguousarray(points), np.ascontiguousarray(triangles), sums)
    length = np.sqrt(np.einsum("ni,ni->n", sums, sums))[:, None]
    return np.asarray(np.divide(sums, length, out=np.zeros_like(sums), where=length > 0))


def cross(u: Floats, v: Floats) -> Floats:
    """(t, 3) cross products, faster than NumPy's for short vectors."""
    (a, b, c), (d, e, f) = u.T, v.T
    return np.stack([b * f - c * e, c * d - a * f, a * e - b * d], axis=1)
