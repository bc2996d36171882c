"""A mesh as a page draws it: triangles, one position a vertex and texture coordinate, normals in eight bits.

A page draws vertices, which have one texture coordinate each; a mesh's points may have several. The points come first,
in their order; where a seam splits one further, a twin of it is appended. So a point that moves travels once.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points, PolygonMesh
from pliant.numerics.meshes.closest_kernels import add_normals
from pliant.numerics.meshes.shown_points import corners_at, packed_normals, shown_normals, shown_points

Integers = NDArray[np.uint32]
_FEW = 0.4  # of the vertices: for fewer, only the triangles around them are looked at


@dataclass(frozen=True, eq=False)
class Moved:
    """Points that have moved, as they are sent while somebody drags.

    Parameters
    ----------
    positions
        (k, 3) in 16 bits a coordinate of the box from ``low`` to ``high``.
    normals
        (k, 3) unit normals in 8 bits.
    low, high
        (3,) corners of the box.
    """

    positions: NDArray[np.uint16]
    normals: NDArray[np.int8]
    low: Points
    high: Points


class DrawnMesh:
    """The parts of a mesh that do not move, as a page draws them."""

    def __init__(self, mesh: PolygonMesh) -> None:
        self.mesh = mesh
        self.triangles = np.ascontiguousarray(mesh.triangles, np.int32)
        self._starts, self._around = corners_at(self.triangles, len(mesh.points))

    def normals(self, points: Points, chosen: NDArray[np.integer] | None = None) -> NDArray[np.int8]:
        """(k, 3) normals of the surface at all points, or at some, in 8 bits."""
        which = np.arange(len(points)) if chosen is None else chosen
        vertices = np.ascontiguousarray(which, np.int64)
        found: NDArray[np.int8]
        if len(vertices) < _FEW * len(points):
            found = shown_normals(points, vertices, self.triangles, self._starts, self._around)
        else:  # each triangle once
            sums = np.zeros(points.shape)
            add_normals(points, self.triangles, sums)
            found = packed_normals(sums, vertices)
        return found

    def moved(self, points: Points, chosen: NDArray[np.integer]) -> Moved:
        """Some points, as they are sent while somebody drags."""
        which = np.ascontiguousarray(chosen, np.int64)
        positions, low, high = shown_points(points, which)
        return Moved(positions, self.normals(points, which), low, high)

    def arrays(self, points: Points) -> dict[str, NDArray[Any]]:
        """All that a page needs to draw the mesh."""
        found: dict[str, NDArray[Any]] = {
            "positions": points.astype(np.float32),
            "normals": self.normals(points),
            "triangles": self._split[0],
            "twins": self._split[1],
        }
        if self._split[2] is not None:
            found["uvs"] = self._split[2]
        return found

    @cached_property
    def edges(self) -> Integers:
        """(e, 2) edges of the polygons."""
        return self.mesh.edges.astype(np.uint32)

    @property
    def parts(self) -> list[dict[str, int]]:
        """Runs of triangles of one material: where each begins in the list of corners, and how long it is."""
        labels = self._labels
        if not len(labels):
            return []
        starts = np.concatenate([[0], np.flatnonzero(np.diff(labels)) + 1])
        ends = np.concatenate([starts[1:], [len(labels)]])
        return [
            {"material": int(labels[start]), "start": int(3 * start), "count": int(3 * (end - start))}
            for start, end in zip(starts, ends, strict=True)
        ]

    @property
    def materials(self) -> list[dict[str, Any]]:
        """What each material looks like; a texture by its number."""
        names = self.mesh.materials.names if self.mesh.materials is not None else ()
        library = self.mesh.material_library
        found = [
            {
                "name": name,
                "color": list(library[name].color) if name in library else None,
                "texture": number if name in library and library[name].texture is not None else None,
            }
            for number, name in enumerate(names)
        ]
        return [*found, {"name": "", "color": None, "texture": None}]

    @cached_property
    def _labels(self) -> NDArray[np.int64]:
        """(t,) the material of each triangle, in the order in which they are drawn."""
        return np.sort(self._material_of, kind="stable")

    @cached_property
    def _material_of(self) -> NDArray[np.int64]:
        if self.mesh.materials is None:
            return np.zeros(len(self.triangles), np.int64)
        labels = self.mesh.materials.indices[self.mesh.triangle_faces].astype(np.int64)
        return np.where(labels < 0, len(self.mesh.materials.names), labels)

    @cached_property
    def _split(self) -> tuple[Integers, Integers, NDArray[np.float32] | None]:
        """(t, 3) triangles of drawn vertices, the points that are drawn again, and (d, 2) texture coordinates."""
        order = np.argsort(self._material_of, kind="stable")
        triangles = self.triangles[order]
        uvs = self.mesh.uvs
        if uvs is None or not len(uvs.values) or not len(triangles):
            return triangles.astype(np.uint32), np.empty(0, np.uint32), None
        corners = uvs.indices[self.mesh.triangle_corners[order]].reshape(-1).astype(np.int64)
        pairs = triangles.reshape(-1).astype(np.int64) * (len(uvs.values) + 1) + corners + 1
        unique, drawn = np.unique(pairs, return_inverse=True)
        owner, value = np.divmod(unique, len(uvs.values) + 1)
        first = np.concatenate([[True], np.diff(owner) > 0])
        place = np.where(first, owner, 0)
        place[~first] = len(self.mesh.points) + np.arange(np.count_nonzero(~first))
        coordinates = np.zeros((len(self.mesh.points) + np.count_nonzero(~first), 2), np.float32)
        with_none = np.vstack([np.zeros((1, 2)), uvs.values[:, :2]])
        coordinates[place] = with_none[value]
        twins = owner[~first].astype(np.uint32)
        return place[drawn.reshape(-1)].reshape(-1, 3).astype(np.uint32), twins, coordinates
