"""Pushing a cage outwards by what sticks out of it, limb by limb, and never so far that it cuts itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.cages.pushing import longest_sides
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.coordinates.winding import winding_numbers
from pliant.numerics.meshes.closest_surface import TriangleSearch
from pliant.numerics.meshes.manifold import flat_triangles
from pliant.numerics.meshes.triangle_crossings import crossings, self_crossings

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_ROUNDS = 40
_PATIENCE = 10
_HALVINGS = 5
_TURNS = 30  # in which vertices that would make the cage cut itself stay where they are
_LONGEST = 0.04  # of the diagonal: a step


class Enclosing:
    """A cage whose faces belong to regions of a mesh.

    What sticks out is brought back by faces of its own region: those of a limb nearby have nothing to do with it. A
    face's corners move by their shares in the place that is nearest to what sticks out.

    Parameters
    ----------
    cage, owners
        The cage, which does not cut itself, and (f,) the region of each face.
    mesh, regions
        What to enclose, and (n,) the region of each vertex.
    clearance
        How much farther than needed a step goes.
    """

    def __init__(self, cage: PolygonMesh, owners: Indices, mesh: PolygonMesh, regions: Indices, clearance: float):
        self._cage, self._owners = cage, owners[cage.triangle_faces]
        self._mesh, self._regions, self._clearance = mesh, regions, clearance
        self._strides = np.clip(0.2 * longest_sides(mesh), clearance, 4 * clearance)

    def solve(self) -> tuple[Points, Points, Indices]:
        """Where the vertices are in the end; (k, 3) where the mesh sticks out all the same, and in which regions."""
        points, triangles = self._cage.points.copy(), self._cage.triangles
        longest = _LONGEST * self._mesh.diagonal
        before = np.inf
        for turn in range(1, _ROUNDS + 1):
            steps, wrong, owners = self._steps(points)
            if not len(wrong):
                return points, wrong, owners
            if turn % _PATIENCE == 0:  # no fewer than some rounds ago: it will not do
                if len(wrong) >= before:
                    return points, wrong, owners
                before = len(wrong)
            lengths = np.linalg.norm(steps, axis=1, keepdims=True)
            steps *= np.minimum(1.0, longest / np.maximum(lengths, 1e-300))
            points = _moved(points, triangles, steps)
        return points, *self._steps(points)[1:]

    def _steps(self, points: Points) -> tuple[Floats, Points, Indices]:
        """(m, 3) where the cage's vertices shall go, (k, 3) places that stick out of it, and the regions of these."""
        mesh, triangles = self._mesh, self._cage.triangles
        pushes = _Pushes(len(points))
        outside = np.flatnonzero(winding_numbers(mesh.points, points, triangles) < 0.5)
        whole = np.setdiff1d(np.arange(len(triangles)), flat_triangles(points, triangles))
        for region in np.unique(self._regions[outside]):
            own = whole[self._owners[whole] == region] if region in self._owners else whole
            given = mesh.points[outside[self._regions[outside] == region]]
            if len(own):
                found = TriangleSearch(points, triangles[own]).query(given)
                pushes.towards(triangles[own[found.triangles]], found.weights, given - found.points, self._clearance)
        pairs = crossings(points, triangles, mesh.points, mesh.triangles)
        pairs = pairs[~np.isin(mesh.triangles[pairs[:, 1]], outside).any(axis=1)]
        pushes.off(points, triangles[pairs[:, 0]], self._strides[pairs[:, 1]])
        wrong = np.concatenate([mesh.points[outside], mesh.points[mesh.triangles[pairs[:, 1]]].mean(axis=1)])
        return pushes.steps, wrong, np.concatenate([self._regions[outside], self._owners[pairs[:, 0]]])


class _Pushes:
    """Steps of vertices: the longest that any push asks for, in the mean direction of all."""

    def __init__(self, count: int) -> None:
        self._sums, self._longest = np.zeros((count, 3)), np.zeros(count)

    def towards(self, triangles: NDArray[np.integer], weights: Floats, away: Floats, more: float) -> None:
        """Push triangles so that their places of these weights go all the way, and farther by ``more``."""
        distance = np.linalg.norm(away, axis=1, keepdims=True)
        shares = weights / (weights**2).sum(axis=1, keepdims=True)
        reach = away * (1 + more / np.maximum(distance, 1e-300))
        for k in range(3):
            self._add(triangles[:, k], shares[:, k, None] * reach)

    def off(self, points: Points, triangles: NDArray[np.integer], by: Floats) -> None:
        """Push whole triangles along their normals, (k,) how far."""
        corners = points[triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        for k in range(3):
            self._add(triangles[:, k], by[:, None] * normals)

    @property
    def steps(self) -> Floats:
        lengths = np.linalg.norm(self._sums, axis=1)
        return np.asarray(self._sums * (self._longest / np.maximum(lengths, 1e-300))[:, None])

    def _add(self, vertices: NDArray[np.integer], steps: Floats) -> None:
        lengths = np.linalg.norm(steps, axis=1)
        np.add.at(self._sums, vertices, lengths[:, None] * steps)
        np.maximum.at(self._longest, vertices, lengths)


def _moved(points: Points, triangles: NDArray[np.integer], steps: Floats) -> Points:
    """Vertices after their steps, shorter ones where the cage would cut itself."""
    part = np.ones(len(points))
    for turn in range(_TURNS):
        moved = points + part[:, None] * steps
        pairs = self_crossings(moved, triangles)
        if not len(pairs):
            return moved
        blocked = triangles[pairs.reshape(-1)].reshape(-1)
        part[blocked] = 0.0 if turn >= _HALVINGS else 0.5 * part[blocked]
    return points


def untangled(cage: PolygonMesh, mesh: PolygonMesh) -> PolygonMesh:
    """A cage some of whose vertices have been brought nearer to the mesh, so that fewer faces cut one another."""
    points, part = cage.points, np.ones(len(cage.points))
    pairs = self_crossings(points, cage.triangles)
    if not len(pairs):
        return cage
    anchors = TriangleSearch(mesh.points, mesh.triangles).query(points).points
    for _ in range(_HALVINGS):
        part[np.unique(cage.triangles[pairs.reshape(-1)])] *= 0.5
        points = anchors + part[:, None] * (cage.points - anchors)
        pairs = self_crossings(points, cage.triangles)
        if not len(pairs):
            break
    return cage.with_points(points)


def spread(points: Points, count: int) -> Points:
    """Some of (k, 3) points, each the farthest from those before it."""
    chosen = [0]
    distance = np.linalg.norm(points - points[0], axis=1)
    while len(chosen) < min(count, len(points)):
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return points[chosen]
