"""PolygonMesh: points, polygons, and everything that rides along.

A mesh is frozen. What a file said is kept as it was said: polygons stay polygons, vertices keep their order and
their number, texture coordinates and normals stay with the corners of faces. Deforming a mesh is
:meth:`PolygonMesh.with_points`: other positions, all else untouched.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from html import escape
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.attributes import CornerValues as CornerValues
from pliant.attributes import FaceLabels as FaceLabels
from pliant.attributes import Material as Material
from pliant.errors import InvalidMesh
from pliant.numerics.given import as_numbers
from pliant.numerics.meshes.adjacency import edge_use, neighbors, unique_edges
from pliant.numerics.meshes.soundness import (
    checked_points,
    checked_rows,
    require_cells,
    require_length,
    require_vertices,
)
from pliant.numerics.meshes.triangulation import polygon_normals, triangulate
from pliant.numerics.ragged import Ragged, frozen

Points = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PolygonMesh:
    """A polygon mesh: frozen, in file order, nothing merged, split or triangulated.

    Parameters
    ----------
    points
        (n, 3) finite float64 positions, in the mesh's own unit. Vertices that no face uses are kept.
    faces
        Ragged rows of vertex indices; any nested sequence or (f, k) array is accepted.
    uvs, normals
        Texture coordinates (k, 2 or 3) and normals (k, 3) per corner of a face.
    groups, objects, materials
        Names that partition the faces.
    material_library
        Materials by name.
    vertex_attributes, face_attributes
        Arrays with one row a vertex, or a face, by name; per-vertex normals are ``"normals"``, colours
        ``"colors"``.
    lines
        Polylines, as rows of vertex indices.
    cells
        Cells of a volume mesh by their kind, such as ``"tetra"``: (c, k) vertex indices each. They ride along; what
        is drawn and measured is the faces.
    source
        Where the mesh was read from.
    carrier
        What its reader kept in order to write the very same file with other positions. Opaque.

    Raises
    ------
    InvalidMesh
        A point that is not finite, a face that uses a vertex that is not there, an attribute of another length.
    """

    points: Points
    faces: Ragged = field(default_factory=lambda: Ragged.of([]))
    uvs: CornerValues | None = None
    normals: CornerValues | None = None
    groups: FaceLabels | None = None
    objects: FaceLabels | None = None
    materials: FaceLabels | None = None
    material_library: Mapping[str, Material] = field(default_factory=dict)
    vertex_attributes: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    face_attributes: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    lines: Ragged | None = None
    cells: Mapping[str, NDArray[np.int32]] = field(default_factory=dict)
    source: Path | None = None
    carrier: Any = None

    def __post_init__(self) -> None:
        given = as_numbers("points", self.points, InvalidMesh)
        points = checked_points(given if given.size else np.empty((0, 3)))
        self._set(points=frozen(points, np.float64), faces=checked_rows(self.faces, "face"))
        if self.lines is not None:
            self._set(lines=checked_rows(self.lines, "line"))
        require_vertices(self.faces, len(points), "face")
        require_vertices(self.lines, len(points), "line")
        for kind, rows in self.cells.items():
            require_cells(np.asarray(rows), len(points), kind)
        for name, labels in (("groups", self.groups), ("objects", self.objects), ("materials", self.materials)):
            if labels is not None:
                require_length(name, labels.indices, len(self.faces), "faces")
        for name, corner in (("uvs", self.uvs), ("normals", self.normals)):
            if corner is not None:
                require_length(name, corner.indices, len(self.faces.flat), "corners")
        for name, values in self.vertex_attributes.items():
            require_length(f"vertex attribute {name!r}", values, len(points), "vertices")
        for name, values in self.face_attributes.items():
            require_length(f"face attribute {name!r}", values, len(self.faces), "faces")
        self._set(
            vertex_attributes=_frozen_mapping(self.vertex_attributes),
            face_attributes=_frozen_mapping(self.face_attributes),
            cells=MappingProxyType({kind: frozen(rows, np.int32) for kind, rows in self.cells.items()}),
            material_library=MappingProxyType(dict(self.material_library)),
        )

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def __reduce__(self) -> tuple[Any, ...]:
        state = {name: getattr(self, name) for name in self.__dataclass_fields__}
        for name in ("vertex_attributes", "face_attributes", "material_library", "cells"):
            state[name] = dict(state[name])  # a mapping proxy does not pickle
        return _rebuild, (state,)

    def with_points(self, points: ArrayLike, *, normals: Points | CornerValues | None = None) -> PolygonMesh:
        """The same mesh with its vertices elsewhere.

        Parameters
        ----------
        points
            (n, 3) one position a vertex.
        normals
            Stored normals that follow from the points: corner values, or an (n, 3) vertex attribute.

        Raises
        ------
        InvalidMesh
            Another number of points, or one that is not finite.
        """
        new = np.asarray(points, np.float64)
        if new.shape != self.points.shape:
            raise InvalidMesh(f"points have shape {new.shape}; this mesh needs {self.points.shape}")
        changes: dict[str, Any] = {"points": new}
        if isinstance(normals, CornerValues):
            changes["normals"] = normals
        elif normals is not None:
            changes["vertex_attributes"] = {**self.vertex_attributes, "normals": normals}
        return self.replace(**changes)

    def replace(self, **changes: Any) -> PolygonMesh:
        """The same mesh with some fields exchanged."""
        return replace(self, **changes)

    @cached_property
    def bounds(self) -> tuple[Points, Points]:
        """The lowest and the highest corner of the bounding box, (3,) each.

        Raises
        ------
        InvalidMesh
            A mesh without points has none.
        """
        if not len(self.points):
            raise InvalidMesh("a mesh without points has no bounds")
        return self.points.min(axis=0), self.points.max(axis=0)

    @property
    def center(self) -> Points:
        """(3,) the middle of the bounding box."""
        low, high = self.bounds
        return (low + high) / 2

    @property
    def diagonal(self) -> float:
        """The length of the bounding box's diagonal: what "small" is measured against."""
        low, high = self.bounds
        return float(np.linalg.norm(high - low))

    @cached_property
    def _cut(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        return triangulate(self.points, self.faces)

    @cached_property
    def triangles(self) -> NDArray[np.int32]:
        """(t, 3) vertex indices of the triangles that the polygons are cut into for computing."""
        return self.faces.flat[self._cut[0]]

    @property
    def triangle_corners(self) -> NDArray[np.int32]:
        """(t, 3) the same triangles as positions in ``faces.flat``: the way to corner data."""
        return self._cut[0]

    @property
    def triangle_faces(self) -> NDArray[np.int32]:
        """(t,) the polygon that each triangle is a piece of."""
        return self._cut[1]

    @cached_property
    def edges(self) -> NDArray[np.int32]:
        """(e, 2) each edge of a polygon once, the lower vertex first, sorted."""
        return unique_edges(self.faces)

    @cached_property
    def neighbors(self) -> Ragged:
        """(n,) for each vertex the sorted vertices that it shares an edge with."""
        return neighbors(self.edges, len(self.points))

    @cached_property
    def edge_use(self) -> tuple[int, int]:
        """How many edges bound one face only, and how many bound three or more (or two that disagree)."""
        return edge_use(self.faces)

    @cached_property
    def vertex_normals(self) -> Points:
        """(n, 3) unit normals computed from the faces, weighted by area; zero where no face defines one."""
        sums = np.zeros_like(self.points)
        np.add.at(sums, self.faces.flat, polygon_normals(self.points, self.faces)[self.faces.row_of])
        length = np.linalg.norm(sums, axis=1, keepdims=True)
        np.divide(sums, length, out=sums, where=length > 0)
        return sums

    def __repr__(self) -> str:
        return f"PolygonMesh({len(self.points):,} points, {len(self.faces):,} faces)"

    def _repr_html_(self) -> str:
        rows = {"points": f"{len(self.points):,}", "faces": f"{len(self.faces):,}"}
        if len(self.points):
            low, high = self.bounds
            rows["size"] = " × ".join(f"{extent:.4g}" for extent in high - low)
        sides = np.unique(self.faces.lengths)
        rows |= {kind: f"{len(each):,}" for kind, each in self.cells.items()}
        rows["corners a face"] = ", ".join(map(str, sides[:6])) + (" …" if len(sides) > 6 else "")
        carried = [
            name
            for name in ("uvs", "normals", "groups", "objects", "materials", "lines")
            if getattr(self, name) is not None
        ]
        rows["carries"] = ", ".join([*carried, *self.vertex_attributes, *self.face_attributes]) or "nothing else"
        body = "".join(f"<tr><th>{name}</th><td>{escape(value)}</td></tr>" for name, value in rows.items())
        return f"<table><caption>PolygonMesh</caption>{body}</table>"


def as_points(target: PolygonMesh | ArrayLike, *, borrow: bool = False, finite: bool = True) -> Points:
    """(n, 3) finite, C-ordered positions of a mesh or of anything that reads as points.

    Parameters
    ----------
    target
        A mesh, or points.
    borrow
        Whether the caller's own array will do, for a use that ends before the caller can change it; else the
        result is read-only for good.
    finite
        Whether to look for coordinates that are not finite; False where the caller does.

    Raises
    ------
    InvalidMesh
        Another shape, or a coordinate that is not finite.
    """
    if isinstance(target, PolygonMesh):
        return target.points
    points = checked_points(target, finite=finite)
    return np.ascontiguousarray(points) if borrow else frozen(points, np.float64)


def _rebuild(state: dict[str, Any]) -> PolygonMesh:
    return PolygonMesh(**state)


def _frozen_mapping(values: Mapping[str, NDArray[Any]]) -> Mapping[str, NDArray[Any]]:
    return MappingProxyType({name: frozen(array, np.asarray(array).dtype) for name, array in values.items()})
