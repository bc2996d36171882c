"""PLY, the Stanford polygon format: elements with any properties, as text or binary of either byte order."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.io.mesh_formats import ply_writer
from pliant.io.mesh_formats.carrier import carrier_of, with_carrier
from pliant.io.mesh_formats.format import Encoded, Keeps, MeshFormat, Source
from pliant.io.mesh_formats.ply_body import Column, decode
from pliant.io.mesh_formats.ply_layout import Header, parse
from pliant.io.mesh_formats.ply_writer import Layout
from pliant.mesh import CornerValues, PolygonMesh
from pliant.numerics.ragged import Ragged

Columns = dict[str, Column]

_UVS = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"))
_COLORS = (("red", "green", "blue"), ("diffuse_red", "diffuse_green", "diffuse_blue"), ("r", "g", "b"))
_ALPHAS = ("alpha", "diffuse_alpha", "a")
_FACES = ("vertex_indices", "vertex_index")


class Ply(MeshFormat):
    """PLY; what it holds beyond a mesh stays in the file that is written back."""

    name = "PLY"
    suffixes = (".ply",)
    keeps = Keeps(
        polygons=True,
        lines=True,
        corner_uvs=True,
        vertex_normals=True,
        vertex_colors=True,
        face_colors=True,
        vertex_attributes=True,
        face_attributes=True,
    )

    def sniff(self, data: bytes) -> bool:
        """Whether the file begins with the word ply."""
        return data[:4] in (b"ply\n", b"ply\r", b"ply ")

    def read(self, source: Source) -> PolygonMesh:
        """The mesh that a PLY file holds."""
        if not self.sniff(source.data):
            raise source.unreadable("the file does not begin with 'ply'", "check what it is", at=0)
        header = parse(source)
        return _Reading(source, header, decode(source, header)).mesh()

    def encode(self, mesh: PolygonMesh, path: Path) -> Encoded:
        """The file that the mesh was read from, with other numbers; a new one if that was none or another."""
        carrier = carrier_of(mesh, self.name)
        return ply_writer.same_file(mesh, carrier) if carrier else ply_writer.new_file(mesh, self.keeps)


@dataclass(frozen=True, eq=False)
class _Reading:
    """A decoded file on its way to a mesh."""

    source: Source
    header: Header
    columns: dict[str, Columns]

    def mesh(self) -> PolygonMesh:
        vertex = dict(self.columns.get("vertex", {}))
        if not {"x", "y", "z"} <= set(vertex):
            raise self.source.unreadable("there are no vertices with x, y and z", "export the file again", at=0)
        layout = Layout(self.header.order, tuple(vertex.pop(name) for name in "xyz"), self._normals(vertex))
        points = np.stack([column.values for column in layout.points], axis=1).astype(np.float64, copy=False)
        self._require_finite(points, layout.points)
        face = dict(self.columns.get("face", {}))
        faces = self._polygons(face, len(points))
        uvs = self._corner_uvs(face, faces) or self._vertex_uvs(vertex, faces)
        vertices, vertex_rest = self._attributes("vertex", vertex)
        if layout.normals:
            normals = np.stack([column.values for column in layout.normals], axis=1)
            vertices["normals"] = normals.astype(np.float64, copy=False)
        face_attributes, face_rest = self._attributes("face", face)
        lines, edge_rest = self._edges(len(points))
        mesh = PolygonMesh(
            points,
            faces,
            uvs=uvs,
            vertex_attributes=vertices,
            face_attributes=face_attributes,
            lines=lines,
        )
        unique = (*vertex_rest, *face_rest, *edge_rest, *self._other_elements())
        return with_carrier(mesh, Ply.name, self.source.data, layout, unique)

    def _normals(self, vertex: Columns) -> tuple[Column, ...]:
        names = ("nx", "ny", "nz")
        return tuple(vertex.pop(name) for name in names) if set(names) <= set(vertex) else ()

    def _require_finite(self, points: NDArray[np.float64], columns: tuple[Column, ...]) -> None:
        if not np.isfinite(points.sum()) and not np.isfinite(points).all():
            row, axis = np.argwhere(~np.isfinite(points))[0]
            at = int(columns[axis].at[row])
            cause = f"vertex {row} lies at {points[row]}"
            raise self.source.unreadable(cause, "remove or correct it", at=at, text=not self.header.order)

    def _polygons(self, face: Columns, count: int) -> Ragged:
        """The polygons; strips of triangles become triangles."""
        name = next((name for name in _FACES if name in face and face[name].offsets is not None), None)
        if name is None:
            strips = self.columns.get("tristrips", {})
            column = next((strips[each] for each in _FACES if each in strips), None)
            return Ragged.of(self._strips(column, count)) if column else Ragged.of([])
        column = face.pop(name)
        assert column.offsets is not None
        self._require_indices(column, column.values, count, 0)
        return Ragged(column.values.astype(np.int32, copy=False), column.offsets)

    def _require_indices(self, column: Column, indices: NDArray[Any], count: int, least: int) -> None:
        if indices.size and not (least <= indices.min() and indices.max() < count and (indices % 1 == 0).all()):
            bad = np.flatnonzero((indices < least) | (indices >= count) | (indices % 1 != 0))[0]
            row = bad if column.offsets is None else int(np.searchsorted(column.offsets, bad, "right") - 1)
            cause = f"face {row} uses vertex {indices[bad]:g}; the file has {count:,}, counted from 0"
            raise self.source.unreadable(
                cause, "correct the index, or export the file again", at=int(column.at[row]), text=not self.header.order
            )

    def _strips(self, column: Column, count: int) -> NDArray[np.int32]:
        """(t, 3) the triangles of strips that -1 separates, every second one turned round."""
        self._require_indices(column, column.values, count, -1)
        indices = column.values.astype(np.int64)
        offsets = np.array([0, len(indices)]) if column.offsets is None else column.offsets
        row = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
        begins = np.ones(len(indices) + 1, bool)
        begins[1:-1] = (indices[:-1] < 0) | (row[1:] != row[:-1])
        first = np.maximum.accumulate(np.where(begins[:-1], np.arange(len(indices)), 0))
        at = np.arange(max(len(indices) - 2, 0))
        trio = np.stack([indices[at], indices[at + 1], indices[at + 2]], axis=1)
        within = (first[at] == first[at + 2]) & (trio >= 0).all(axis=1)
        odd = ((at - first[at]) % 2).astype(bool)
        trio[odd] = trio[odd][:, [1, 0, 2]]
        distinct = (trio[:, 0] != trio[:, 1]) & (trio[:, 1] != trio[:, 2]) & (trio[:, 0] != trio[:, 2])
        kept: NDArray[np.int32] = trio[within & distinct].astype(np.int32)
        return kept

    def _corner_uvs(self, face: Columns, faces: Ragged) -> CornerValues | None:
        column = face.get("texcoord")
        if column is None or column.offsets is None or not len(faces):
            return None
        if not np.array_equal(np.diff(column.offsets), 2 * faces.lengths):
            return None
        values = face.pop("texcoord").values.astype(np.float64).reshape(-1, 2)
        return CornerValues(values, np.arange(len(values), dtype=np.int32))

    def _vertex_uvs(self, vertex: Columns, faces: Ragged) -> CornerValues | None:
        names = next((names for names in _UVS if set(names) <= set(vertex)), None)
        if names is None or any(vertex[name].offsets is not None for name in names) or not len(faces):
            return None
        values = np.stack([vertex.pop(name).values for name in names], axis=1)
        return CornerValues(values.astype(np.float64, copy=False), faces.flat)

    def _attributes(self, element: str, columns: Columns) -> tuple[dict[str, Any], tuple[str, ...]]:
        """What is left of an element's properties, by name; lists of different lengths are told of, not kept."""
        result: dict[str, Any] = {}
        rest = []
        types = {
            each.name: np.dtype(each.type)
            for part in self.header.elements
            if part.name == element
            for each in part.properties
        }
        columns = {name: self._typed(column, types[name]) for name, column in columns.items()}
        names = next((names for names in _COLORS if set(names) <= set(columns)), None)
        if names is not None:
            alphas = [name for name in _ALPHAS if name in columns][:1]
            result["colors"] = np.stack([columns.pop(name).values for name in (*names, *alphas)], axis=1)
        for name, column in columns.items():
            if column.offsets is None:
                result[name] = column.values
            elif (each := Ragged(np.zeros(len(column.values), np.int32), column.offsets).uniform) is not None:
                result[name] = column.values.reshape(len(column.offsets) - 1, each)
            else:
                rest.append(f"the lists {name!r} of the element {element!r}")
        return result, tuple(rest)

    def _typed(self, column: Column, kind: np.dtype[Any]) -> Column:
        """A text's numbers in the type that its header declares, where they fit it."""
        if column.values.dtype == kind:
            return column
        with np.errstate(all="ignore"):
            typed = column.values.astype(kind)
        fits = kind.kind == "f" or np.array_equal(typed, column.values)
        return Column(typed if fits else column.values, column.at, column.offsets)

    def _edges(self, count: int) -> tuple[Ragged | None, tuple[str, ...]]:
        edge = dict(self.columns.get("edge", {}))
        if not {"vertex1", "vertex2"} <= set(edge):
            return None, ()
        ends = [edge.pop(name) for name in ("vertex1", "vertex2")]
        for end in ends:
            self._require_indices(end, end.values, count, 0)
        rest = (f"{len(edge)} properties of edges",) if edge else ()
        return Ragged.of(np.stack([end.values for end in ends], axis=1).astype(np.int32)), rest

    def _other_elements(self) -> tuple[str, ...]:
        known = {"vertex", "face", "edge", "tristrips"}
        return tuple(f"{each.count:,} of {each.name!r}" for each in self.header.elements if each.name not in known)
