"""glTF 2.0 and GLB: the scene's meshes as one, each vertex where its node puts it.

Vertices stay as they are stored, those that seams split included, in the order of the scene. Texture coordinates
count upwards here and downwards in the file.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnsupportedFormat
from pliant.io.mesh_formats import gltf_builder, gltf_writer
from pliant.io.mesh_formats.carrier import carrier_of, with_carrier
from pliant.io.mesh_formats.format import Encoded, Keeps, MeshFormat, Source
from pliant.io.mesh_formats.gltf_file import GltfFile, companion, item, opened
from pliant.io.mesh_formats.gltf_scene import Matrix, placed_nodes, unit
from pliant.io.mesh_formats.gltf_writer import Layout, Part
from pliant.mesh import CornerValues, FaceLabels, Material, PolygonMesh
from pliant.numerics.ragged import Ragged

_KNOWN = {"POSITION", "NORMAL", "TEXCOORD_0", "COLOR_0"}
_MOST = 50_000_000  # vertices; nodes may repeat a mesh without end


class Gltf(MeshFormat):
    """glTF and GLB; what a scene holds beyond a mesh stays in the file that is written back."""

    name = "glTF"
    suffixes = (".glb", ".gltf")
    keeps = Keeps(
        lines=True,
        corner_uvs=True,
        corner_normals=True,
        vertex_normals=True,
        vertex_colors=True,
        materials=True,
        textures=True,
        precision="float32",
    )

    def sniff(self, data: bytes) -> bool:
        """Whether the file is a GLB, or JSON that speaks of an asset."""
        return data.startswith(b"glTF") or (data[:8].strip(b"\xef\xbb\xbf \t\r\n")[:1] == b"{" and b'"asset"' in data)

    def read(self, source: Source) -> PolygonMesh:
        """The meshes of the scene, as one."""
        try:
            return _Reading(opened(source)).mesh()
        except (KeyError, IndexError, TypeError, ValueError, AttributeError, OverflowError) as error:
            cause = f"the description contradicts itself ({type(error).__name__}: {error})"
            raise source.unreadable(cause[:200], "export the file again") from error

    def encode(self, mesh: PolygonMesh, path: Path) -> Encoded:
        """The file that the mesh was read from, with other numbers; a new one if that cannot hold them."""
        carrier = carrier_of(mesh, self.name)
        same = gltf_writer.same_file(mesh, carrier, path) if carrier else None
        return same or gltf_builder.new_file(mesh, self.keeps, path)


@dataclass(eq=False)
class _Reading:
    """A scene on its way to a mesh."""

    file: GltfFile
    parts: dict[Any, Part] = field(default_factory=dict)
    total: int = 0
    columns: dict[str, list[NDArray[Any]]] = field(default_factory=lambda: {"points": [], "normals": [], "uvs": []})
    colors: list[NDArray[Any] | None] = field(default_factory=list)
    faces: list[NDArray[np.int64]] = field(default_factory=list)
    lines: list[NDArray[np.int64]] = field(default_factory=list)
    materials: list[NDArray[np.int32]] = field(default_factory=list)
    objects: list[NDArray[np.int32]] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    unique: dict[str, None] = field(default_factory=dict)

    def mesh(self) -> PolygonMesh:
        """Collect all primitives and put them together."""
        for node, matrix in placed_nodes(self.file):
            self._node(item(self.file.json["nodes"], node), node, matrix)
        if not self.total:
            raise self.file.source.unreadable("the scene holds no mesh", "export it with its meshes")
        triangles = np.concatenate([np.empty((0, 3), np.int64), *self.faces]).astype(np.int32)
        flat = triangles.reshape(-1)
        mesh = PolygonMesh(
            np.concatenate(self.columns["points"]),
            Ragged.of(triangles),
            uvs=_corners(self.columns["uvs"], flat),
            normals=_corners(self.columns["normals"], flat),
            objects=FaceLabels(tuple(self.names), np.concatenate(self.objects)) if self.objects else None,
            lines=Ragged.of(np.concatenate(self.lines).astype(np.int32)) if self.lines else None,
            vertex_attributes=self._vertex_colors(),
            **self._materials(),
        )
        layout = Layout(self.file, tuple(self.parts.values()))
        return with_carrier(mesh, Gltf.name, self.file.source.data, layout, tuple(self.unique))

    def _node(self, node: dict[str, Any], index: int, matrix: Matrix) -> None:
        mesh = item(self.file.json["meshes"], node["mesh"])
        if "EXT_mesh_gpu_instancing" in node.get("extensions", {}):
            raise UnsupportedFormat(f"{self.file.source.name}: instances by EXT_mesh_gpu_instancing; export them whole")
        moving = [
            word
            for word, found in (
                ("a skin", "skin" in node),
                ("morph targets", any(each.get("targets") for each in mesh["primitives"])),
            )
            if found
        ]
        if moving and not self.file.source.freeze:
            raise UnsupportedFormat(
                f"{self.file.source.name}: node {index} has {' and '.join(moving)}; freeze=True reads the shape at rest"
            )
        self.unique |= dict.fromkeys(moving)
        if "skin" in node:
            matrix = np.eye(4)  # a skin's joints alone say where its vertices are; at rest these are their own
        self.names.append(str(node.get("name") or mesh.get("name") or f"node {index}"))
        for primitive in mesh["primitives"]:
            self._primitive(primitive, index, matrix)

    def _primitive(self, primitive: dict[str, Any], node: int, matrix: Matrix) -> None:
        if "KHR_draco_mesh_compression" in primitive.get("extensions", {}):
            raise UnsupportedFormat(f"{self.file.source.name}: compressed by Draco; export it without mesh compression")
        attributes = primitive["attributes"]
        key = (node, *sorted(attributes.items()))
        if key not in self.parts:
            self.parts[key] = self._vertices(attributes, matrix)
        part = self.parts[key]
        indices = np.arange(part.count)
        if "indices" in primitive:
            indices = self.file.values(primitive["indices"])[:, 0].astype(np.int64)
        if indices.size and not 0 <= indices.min() <= indices.max() < part.count:
            cause = f"node {node}: a primitive uses vertex {indices.max()}; it has {part.count:,}"
            raise self.file.source.unreadable(cause, "export the file again")
        mode = primitive.get("mode", 4)
        if mode >= 4:
            triangles = _TRIANGLES[mode](indices) + part.first
            if np.linalg.det(matrix[:3, :3]) < 0:  # a mirrored node turns its faces round
                triangles = triangles[:, ::-1]
            self.faces.append(triangles)
            self.materials.append(np.full(len(triangles), primitive.get("material", -1), np.int32))
            self.objects.append(np.full(len(triangles), len(self.names) - 1, np.int32))
        elif mode >= 1:
            self.lines.append(_SEGMENTS[mode](indices) + part.first)

    def _vertices(self, attributes: dict[str, int], matrix: Matrix) -> Part:
        positions = self.file.values(attributes["POSITION"]).astype(np.float64)
        count = len(positions)
        first, self.total = self.total, self.total + count
        if positions.shape[1] != 3 or self.total > _MOST:
            raise self.file.source.unreadable(
                f"{self.total:,} vertices of {positions.shape[1]} coordinates", "too many"
            )
        self.columns["points"].append(positions @ matrix[:3, :3].T + matrix[:3, 3])
        normals = np.full((count, 3), np.nan)
        if "NORMAL" in attributes:
            normals = unit(self._rows(attributes["NORMAL"], count, 3) @ np.linalg.pinv(matrix[:3, :3]))
        self.columns["normals"].append(normals)
        uvs = np.full((count, 2), np.nan)
        if "TEXCOORD_0" in attributes:
            uvs = self._rows(attributes["TEXCOORD_0"], count, 2) * [1, -1] + [0, 1]
        self.columns["uvs"].append(uvs)
        self.colors.append(self._color(attributes["COLOR_0"], count) if "COLOR_0" in attributes else None)
        self.unique |= dict.fromkeys(f"the vertex attribute {name!r}" for name in sorted(set(attributes) - _KNOWN))
        places = [self.file.place(attributes[name]) if name in attributes else None for name in ("POSITION", "NORMAL")]
        assert places[0] is not None
        return Part(first, count, matrix, attributes["POSITION"], places[0], places[1])

    def _rows(self, accessor: int, count: int, width: int) -> NDArray[np.float64]:
        values = self.file.values(accessor).astype(np.float64)
        if values.shape != (count, width) or not np.isfinite(values).all():
            raise ValueError(f"accessor {accessor} has the shape {values.shape} and must have {(count, width)}")
        return values

    def _color(self, accessor: int, count: int) -> NDArray[Any]:
        place = self.file.place(accessor)
        if place.dtype == np.uint8:
            return place.view(self.file.buffers[place.buffer]).copy()
        return self._rows(accessor, count, place.shape[1])

    def _vertex_colors(self) -> dict[str, NDArray[Any]]:
        """Colours, where all vertices have some of one kind."""
        kinds = {None if each is None else (each.dtype, each.shape[1]) for each in self.colors}
        if len(kinds) == 1 and None not in kinds:
            return {"colors": np.concatenate([each for each in self.colors if each is not None])}
        if len(kinds) > 1:
            self.unique["the colours of some vertices"] = None
        return {}

    def _materials(self) -> dict[str, Any]:
        said = self.file.json.get("materials", [])
        names: list[str] = []
        for i, each in enumerate(said):
            name = str(each.get("name") or f"material {i}")
            names.append(name if name not in names else f"{name} {i}")
        library = {name: self._material(name, each) for name, each in zip(names, said, strict=True)}
        if not self.materials or not said:
            return {"material_library": library}
        return {"material_library": library, "materials": FaceLabels(tuple(names), np.concatenate(self.materials))}

    def _material(self, name: str, said: dict[str, Any]) -> Material:
        surface = said.get("pbrMetallicRoughness", {})
        red, green, blue = map(float, surface.get("baseColorFactor", [1, 1, 1, 1])[:3])
        texture = None
        if "baseColorTexture" in surface:
            found = item(self.file.json["textures"], surface["baseColorTexture"]["index"])
            image = item(self.file.json["images"], found["source"]) if "source" in found else {}
            uri = image.get("uri", "data:")
            texture = companion(self.file.source.folder, uri)
            if uri.startswith("data:"):
                self.unique["pictures inside the file"] = None
        return Material(name, (red, green, blue), texture)


def _corners(columns: list[NDArray[np.float64]], flat: NDArray[np.int32]) -> CornerValues | None:
    """One value a vertex, as values at corners; none where the vertex has none."""
    values = np.concatenate(columns)
    missing = np.isnan(values[:, 0])
    if missing[flat].all():
        return None
    return CornerValues(np.nan_to_num(values), np.where(missing[flat], -1, flat).astype(np.int32))


def _strip(indices: NDArray[np.int64]) -> NDArray[np.int64]:
    at = np.arange(max(len(indices) - 2, 0))[:, None]
    return indices[at + np.where(at % 2, [1, 0, 2], [0, 1, 2])]


def _fan(indices: NDArray[np.int64]) -> NDArray[np.int64]:
    at = np.arange(max(len(indices) - 2, 0))
    return indices[np.stack([0 * at, at + 1, at + 2], axis=1)]


Cut = Callable[[NDArray[np.int64]], NDArray[np.int64]]
_TRIANGLES: dict[int, Cut] = {4: lambda rows: rows[: len(rows) // 3 * 3].reshape(-1, 3), 5: _strip, 6: _fan}
_SEGMENTS: dict[int, Cut] = {
    1: lambda rows: rows[: len(rows) // 2 * 2].reshape(-1, 2),
    2: lambda rows: np.stack([rows, np.roll(rows, -1)], axis=1),
    3: lambda rows: np.stack([rows[:-1], rows[1:]], axis=1),
}
