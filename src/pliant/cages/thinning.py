"""A surface around a mesh made coarser and coarser: at any time it encloses the mesh and does not cut itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points, PolygonMesh
from pliant.numerics.meshes.box_trees import box_tree, space_order
from pliant.numerics.meshes.collapsing_kernels import VALENCE, collapse_edges
from pliant.numerics.meshes.moving_kernels import flip_edges, move_vertices

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_EVEN = 2e-3  # how much a vertex's own place counts beside the planes around it: faces become more even
_GAIN = 0.03  # by which the cosine of a least angle must become better
_HALVINGS = 5


class Thinning:
    """A surface that is made coarser.

    Parameters
    ----------
    mesh
        What it encloses.
    points, triangles
        The surface: a closed manifold that encloses the mesh and does not cut itself.
    rings
        For each ring the vertices on it in order, its plane's unit normal, and (sides, 3) where its corners shall be.
    """

    def __init__(
        self, mesh: PolygonMesh, points: Points, triangles: Indices, rings: list[tuple[Indices, Floats, Points]]
    ):
        self._center = mesh.center
        self._points = points - self._center
        self._faces = np.ascontiguousarray(triangles[space_order(points, triangles)])
        self._boxes = box_tree(self._points, self._faces)
        order = space_order(mesh.points, mesh.triangles)
        self._mesh = np.ascontiguousarray((mesh.points - self._center)[mesh.triangles[order]])
        self._mesh_boxes = box_tree(mesh.points - self._center, mesh.triangles[order])
        self._around, self._valence = _faces_around(self._faces, len(points))
        self._quadrics = _quadrics(self._points, self._faces)
        self._ring, self._sector = np.full(len(points), -1), np.full(len(points), -1)
        self._following = np.full(len(points), -1)
        self._targets = np.concatenate([np.zeros((1, 3)), *(corners - self._center for *_, corners in rings)])
        self._planes = np.concatenate([np.zeros((1, 3)), *(normal[None] for _, normal, _ in rings)])
        first = 1
        for number, (rim, _, corners) in enumerate(rings, start=1):
            self._ring[rim] = number
            self._following[rim] = np.roll(rim, -1)
            self._sector[rim] = first + sectors(points[rim], corners)
            first += len(corners)

    @property
    def vertices(self) -> int:
        """How many there are."""
        return int((self._valence > 0).sum())

    @property
    def rings_done(self) -> bool:
        """Whether no ring has two vertices for a corner."""
        corners = self._sector[(self._ring >= 0) & (self._valence > 0)]
        return len(np.unique(corners)) == len(corners)

    def collapse(self, wanted: int, room: float, reach: float, limit: float = np.inf) -> None:
        """Collapse edges until there are no more vertices than wanted, or none can.

        Parameters
        ----------
        wanted
            How many vertices.
        room
            How far the mesh stays behind faces.
        reach
            The unit in which vertices go outwards.
        limit
            The largest error, an area times a squared distance; rings are made coarser whatever it is.
        """
        collapse_edges(
            self._points, self._faces, self._boxes, self._around, self._valence, self._quadrics, self._ring,
            self._sector, self._following, self._targets, self._planes, self._mesh, self._mesh_boxes, room, reach,
            wanted, limit,
        )  # fmt: skip

    def flip(self, room: float) -> int:
        """Flip edges that make thin faces; how many were."""
        return int(
            flip_edges(
                self._points, self._faces, self._boxes, self._around, self._valence, self._ring, self._following,
                self._mesh, self._mesh_boxes, room, _GAIN,
            )
        )  # fmt: skip

    def smooth(self, part: float, room: float) -> None:
        """Move vertices part of the way towards their neighbours' mean, and rings to where they shall be."""
        faces = self._faces[self._faces[:, 0] >= 0]
        half = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
        sums = np.zeros_like(self._points)
        np.add.at(sums, half[:, 0], self._points[half[:, 1]])
        counts = np.bincount(half[:, 0], minlength=len(sums))[:, None]
        means = sums / np.maximum(counts, 1)
        goals = np.where(counts > 0, self._points + part * (means - self._points), self._points)
        on = self._ring >= 0
        goals[on] = self._targets[self._sector[on]]
        move_vertices(
            self._points, self._faces, self._boxes, self._around, self._valence, goals, self._mesh, self._mesh_boxes,
            room, _HALVINGS,
        )  # fmt: skip

    def surface(self) -> tuple[Points, Indices, list[Indices]]:
        """The points and triangles that are left, and the rings."""
        faces = self._faces[self._faces[:, 0] >= 0]
        used = np.unique(faces)
        place = np.full(len(self._points), -1)
        place[used] = np.arange(len(used))
        rings = []
        for number in range(1, len(self._planes)):
            on = np.flatnonzero((self._ring == number) & (self._valence > 0))
            ring = [int(on[0])]
            while (at := int(self._following[ring[-1]])) != ring[0]:
                ring.append(at)
            rings.append(place[ring])
        return self._points[used] + self._center, place[faces], rings


def sectors(points: Points, corners: Points) -> Indices:
    """(k,) which corner of a ring each vertex of a loop belongs to; each has a run of them, if there are enough."""
    away = np.linalg.norm(points[:, None] - corners, axis=2)
    nearest = away.argmin(axis=0)
    start, count = nearest[0], len(points)
    steps = (nearest - start) % count
    if (np.diff(steps) <= 0).any():  # a loop that winds: even shares of its length
        lengths = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
        along = np.concatenate([[0.0], np.cumsum(np.roll(lengths, -start))[:-1]]) / lengths.sum()
        found = np.floor(along * len(corners) + 0.5).astype(np.int64) % len(corners)
    else:
        borders = (steps + np.append(steps[1:], count)) / 2
        found = np.searchsorted(borders, np.arange(count), side="right") % len(corners)
    return np.asarray(np.roll(found, start))


def _faces_around(faces: Indices, count: int) -> tuple[Indices, Indices]:
    valence = np.bincount(faces.reshape(-1), minlength=count)
    around = np.full((count, max(VALENCE, int(valence.max(initial=0)) + 1)), -1)
    order = np.argsort(faces.reshape(-1), kind="stable")
    within = np.arange(len(order)) - np.repeat(np.cumsum(valence) - valence, valence)
    around[faces.reshape(-1)[order], within] = order // 3
    return around, valence


def _quadrics(points: Points, faces: Indices) -> Floats:
    """(n, 10) sums of squared distances from the planes around each vertex, and a little from the vertex itself."""
    corners = points[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normals, axis=1)
    normals /= np.maximum(area, 1e-300)[:, None]
    offset = -np.einsum("ti,ti->t", normals, corners[:, 0])
    plane = np.column_stack([normals, offset])
    i, j = np.array([0, 0, 0, 1, 1, 2, 0, 1, 2, 3]), np.array([0, 1, 2, 1, 2, 2, 3, 3, 3, 3])
    each = area[:, None] * plane[:, i] * plane[:, j]
    result, areas = np.zeros((len(points), 10)), np.zeros(len(points))
    for k in range(3):
        np.add.at(result, faces[:, k], each)
        np.add.at(areas, faces[:, k], area)
    weight = _EVEN * areas
    result[:, [0, 3, 5]] += weight[:, None]
    result[:, 6:9] -= weight[:, None] * points
    result[:, 9] += weight * (points**2).sum(axis=1)
    return result
