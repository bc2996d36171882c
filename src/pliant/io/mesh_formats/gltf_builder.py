"""A new glTF of triangles, from a mesh of any other origin."""

from __future__ import annotations

import base64
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.io.mesh_formats.colors import as_float, is_color
from pliant.io.mesh_formats.format import Encoded, Keeps
from pliant.io.mesh_formats.gltf_file import packed
from pliant.io.mesh_formats.gltf_scene import unit
from pliant.io.mesh_formats.losses import as_float32, losses_of
from pliant.io.text import shown
from pliant.mesh import CornerValues, Material, PolygonMesh

_PICTURES = {".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg"}
_ARRAY, _ELEMENTS = 34962, 34963


@dataclass(eq=False)
class _Building:
    """A description and its one buffer, growing."""

    chunk: bytearray = field(default_factory=bytearray)
    views: list[dict[str, Any]] = field(default_factory=list)
    accessors: list[dict[str, Any]] = field(default_factory=list)

    def view(self, data: bytes, **more: Any) -> int:
        """A view of bytes, which begins at a multiple of four."""
        self.chunk += b"\0" * (-len(self.chunk) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.chunk), "byteLength": len(data), **more})
        self.chunk += data
        return len(self.views) - 1

    def accessor(self, values: NDArray[Any], target: int = _ARRAY, **more: Any) -> int:
        """An accessor of (n,) indices or (n, d) values."""
        kind = {"float32": 5126, "uint32": 5125, "uint8": 5121}[values.dtype.name]
        width = 1 if values.ndim == 1 else values.shape[1]
        stride = {}
        if values.dtype == np.uint8 and width == 3:  # rows begin at multiples of four
            values, stride = np.pad(values, [(0, 0), (0, 1)]), {"byteStride": 4}
        view = self.view(np.ascontiguousarray(values).tobytes(), target=target, **stride)
        name = "SCALAR" if width == 1 else f"VEC{width}"
        said = {"bufferView": view, "componentType": kind, "count": len(values), "type": name, **more}
        self.accessors.append(said)
        return len(self.accessors) - 1


def new_file(mesh: PolygonMesh, keeps: Keeps, path: Path) -> Encoded:
    """A GLB, or a description with its buffer inside, written from the mesh alone."""
    losses = list(losses_of(mesh, keeps))
    made = _Building()
    source, corner_of, triangles = split(mesh)
    if more := len(source) - len(mesh.points):
        losses.append(f"{more:,} vertices are added where seams split them")
    if mesh.uvs is not None and ((mesh.uvs.indices < 0).any() or mesh.uvs.values[:, 2:].any()):
        losses.append("texture coordinates of three components, and that corners have none")
    if mesh.normals is not None and (mesh.normals.indices < 0).any():
        losses.append("that corners have no normals")
    points, rounding = as_float32(mesh.points, "glTF")
    losses += rounding
    attributes = _attributes(mesh, made, points[source], source, corner_of)
    labels, known = mesh.materials, list(mesh.material_library)
    if labels is not None:
        known += [name for name in labels.names if name not in known]
    surfaces, order = _surfaces(mesh, made, triangles, known)
    lines, cut = _lines(mesh, made)
    told = _scaled(mesh) + order
    losses += cut
    primitives = [{"attributes": attributes, **said} for said in surfaces + lines or [{"mode": 0}]]
    json: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "pliant"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": path.stem}],
        "meshes": [{"primitives": primitives}],
    }
    notes = _materials(json, made, [mesh.material_library.get(name, Material(name)) for name in known])
    json |= {"accessors": made.accessors, "bufferViews": made.views, "buffers": [{"byteLength": len(made.chunk)}]}
    binary = path.suffix.lower() == ".glb"
    if not binary:
        head = "data:application/octet-stream;base64,"
        json["buffers"][0]["uri"] = head + base64.b64encode(made.chunk).decode()
    return Encoded(packed(json, made.chunk, binary=binary), tuple(losses), (*told, *notes))


def split(mesh: PolygonMesh) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.integer[Any]]]:
    """The vertex that each of the file's is made from, a corner where it is used or -1, and (t, 3) triangles.

    A vertex keeps its place; another is added at the end for each further combination of coordinates and normals
    that its corners have.
    """
    flat, count, corner_of = mesh.faces.flat.astype(np.int64), len(mesh.points), corners_of(mesh)
    columns = [each.indices for each in (mesh.uvs, mesh.normals) if each is not None]
    if all((column == column[corner_of[flat]]).all() for column in columns):
        return np.arange(count), corner_of, mesh.triangles
    key = flat
    for column in columns:
        key = key * (int(column.max()) + 2) + column + 1
    _, first, which = np.unique(key, return_index=True, return_inverse=True)
    vertex = flat[first]
    leads = np.diff(vertex, prepend=-1) != 0
    place = vertex.copy()
    place[~leads] = count + np.arange(int((~leads).sum()))
    source = np.concatenate([np.arange(count), vertex[~leads]])
    corner_of = np.full(len(source), -1)
    corner_of[place] = first
    return source, corner_of, place[which][mesh.triangle_corners]


def corners_of(mesh: PolygonMesh) -> NDArray[np.int64]:
    """(n,) a corner where each vertex is used, or -1."""
    found = np.full(len(mesh.points), -1)
    found[mesh.faces.flat] = np.arange(len(mesh.faces.flat))
    return found


def _surfaces(
    mesh: PolygonMesh, made: _Building, triangles: NDArray[np.integer[Any]], known: list[str]
) -> tuple[list[dict[str, Any]], tuple[str, ...]]:
    """The (t, 3) triangles of each material, all of them where there is none; and that their order is another."""
    labels = mesh.materials
    if not len(triangles):
        return [], ()
    if labels is None:
        return [{"indices": made.accessor(triangles.astype(np.uint32).ravel(), _ELEMENTS)}], ()
    which = labels.indices[mesh.triangle_faces]
    found = []
    for label in np.unique(which).tolist():
        said: dict[str, Any] = {
            "indices": made.accessor(triangles[which == label].astype(np.uint32).ravel(), _ELEMENTS)
        }
        if label >= 0:
            said["material"] = known.index(labels.names[label])
        found.append(said)
    moved = int((np.sort(which, kind="stable") != which).sum())
    told = f"the triangles of a material are put together: the order of {moved:,} is another"
    return found, (told,) if moved else ()


def _lines(mesh: PolygonMesh, made: _Building) -> tuple[list[dict[str, Any]], list[str]]:
    """The mesh's lines as segments, and that longer ones are cut."""
    if mesh.lines is None:
        return [], []
    first = np.ones(len(mesh.lines.flat), bool)
    first[mesh.lines.offsets[1:][mesh.lines.lengths > 0] - 1] = False
    at = np.flatnonzero(first)
    longer = int((mesh.lines.lengths != 2).sum())
    ends = mesh.lines.flat[np.stack([at, at + 1], axis=1)].astype(np.uint32).ravel()
    cut = [f"{longer:,} lines of more than two points are cut into segments"] if longer else []
    return [{"indices": made.accessor(ends, _ELEMENTS), "mode": 1}], cut


def _attributes(
    mesh: PolygonMesh,
    made: _Building,
    points: NDArray[np.float32],
    source: NDArray[np.int64],
    corner_of: NDArray[np.int64],
) -> dict[str, int]:
    """The accessors of the vertices' values."""
    bounds = {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()} if len(points) else {}
    result = {"POSITION": made.accessor(points, **bounds)}
    turned = normals_of(mesh, source, corner_of)
    if turned is not None:
        result["NORMAL"] = made.accessor(turned.astype(np.float32))
    if mesh.uvs is not None and len(mesh.uvs.values):
        uvs = _at_corners(mesh.uvs, corner_of)[:, :2] * [1, -1] + [0, 1]
        result["TEXCOORD_0"] = made.accessor(uvs.astype(np.float32))
    colors = mesh.vertex_attributes.get("colors")
    if colors is not None and is_color(colors):
        typed = colors if colors.dtype == np.uint8 else as_float(colors).astype(np.float32)
        result["COLOR_0"] = made.accessor(typed[source], normalized=bool(typed.dtype == np.uint8))
    return result


def normals_of(
    mesh: PolygonMesh, source: NDArray[np.int64], corner_of: NDArray[np.int64]
) -> NDArray[np.float64] | None:
    """(m, 3) unit normals of a file's vertices, made as :func:`split` says; None where the mesh has none."""
    values = mesh.vertex_attributes.get("normals")
    found = None if values is None else np.asarray(values, np.float64)[source]
    if mesh.normals is not None and len(mesh.normals.values):
        found = _at_corners(mesh.normals, corner_of)
    if found is None:
        return None
    empty = ~found.any(axis=1)
    result = unit(found)
    result[empty] = [0, 0, 1]  # a normal must have a length
    return result


def _scaled(mesh: PolygonMesh) -> tuple[str, ...]:
    """That normals get unit length, where they have none: the format asks for it."""
    values = mesh.vertex_attributes.get("normals") if mesh.normals is None else mesh.normals.values
    if values is None or not len(values):
        return ()
    lengths = np.linalg.norm(values, axis=1)
    long, short = lengths.max(), lengths.min()
    return (
        ()
        if 0.999 < short <= long < 1.001
        else (f"normals become of unit length; theirs are {short:.3g} to {long:.3g}",)
    )


def _at_corners(values: CornerValues, corner_of: NDArray[np.int64]) -> NDArray[np.float64]:
    """(m, d) the values at some corners, zero where there is none."""
    index = np.where(corner_of >= 0, values.indices[corner_of], -1) if len(values.indices) else corner_of
    return np.where((index >= 0)[:, None], values.values[index], 0.0)


def _materials(json: dict[str, Any], made: _Building, materials: list[Material]) -> list[str]:
    """Describe materials with their pictures inside; returns notes of those that are not there."""
    notes: list[str] = []
    images: dict[Path, int] = {}
    for material in materials:
        surface: dict[str, Any] = {"baseColorFactor": [*material.color, 1.0], "metallicFactor": 0.0}
        picture = material.texture
        if picture is not None:
            if picture.suffix.lower() not in _PICTURES or not picture.is_file():
                notes.append(f"the picture {picture.name!r} is not there, or neither PNG nor JPEG")
            else:
                if picture not in images:
                    kind = _PICTURES[picture.suffix.lower()]
                    said = {"bufferView": made.view(picture.read_bytes()), "mimeType": kind, "name": picture.stem}
                    json.setdefault("images", []).append(said)
                    json.setdefault("textures", []).append({"source": len(images)})
                    images[picture] = len(images)
                surface["baseColorTexture"] = {"index": images[picture]}
        said = {"name": shown(material.name), "pbrMetallicRoughness": surface, "doubleSided": True}
        json.setdefault("materials", []).append(said)
    return notes
