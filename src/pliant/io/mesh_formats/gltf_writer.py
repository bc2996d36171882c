"""Writing glTF: the very same scene with other positions and normals."""

from __future__ import annotations

import base64
import copy
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

import numpy as np
from numpy.typing import NDArray

from pliant.io.mesh_formats import mtl
from pliant.io.mesh_formats.carrier import Carrier
from pliant.io.mesh_formats.format import Encoded
from pliant.io.mesh_formats.gltf_file import GltfFile, Place, companion, packed
from pliant.io.mesh_formats.gltf_scene import Matrix, unit
from pliant.mesh import PolygonMesh

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Part:
    """Vertices that stand together: where in the mesh and in the buffers, and the matrix that their node gives them."""

    first: int
    count: int
    matrix: Matrix
    accessor: int
    points: Place
    normals: Place | None


@dataclass(frozen=True, eq=False)
class Layout:
    """The file, and its parts in the order of the mesh's vertices."""

    file: GltfFile
    parts: tuple[Part, ...]


def same_file(mesh: PolygonMesh, carrier: Carrier, path: Path) -> Encoded | None:
    """The file that the mesh was read from with its positions and normals exchanged, in the types that they had.

    None where it cannot hold them: a mesh that stands in several places moved differently there, or a node scales
    it to nothing.
    """
    layout: Layout = carrier.layout
    file = layout.file
    if (path.suffix.lower() == ".glb") != file.binary:
        return None
    buffers = [bytearray(each) for each in file.buffers]
    json = copy.deepcopy(file.json)
    moved: NDArray[np.bool_] = np.any(carrier.mesh.points != mesh.points, axis=1)
    old, new = _vertex_normals(carrier.mesh), _vertex_normals(mesh)
    turned: NDArray[np.bool_] = np.any(old != new, axis=1)
    steps = [0.0]
    for part in layout.parts:
        rows = slice(part.first, part.first + part.count)
        linear = part.matrix[:3, :3]
        if moved[rows].any():
            if np.linalg.matrix_rank(linear) < 3:
                return None
            local = np.asarray(np.linalg.solve(linear, (mesh.points[rows] - part.matrix[:3, 3]).T).T, np.float64)
            steps.append(_put(part.points, buffers, local, moved[rows]) * float(np.abs(linear).max()))
            stored = part.points.view(buffers[part.points.buffer])
            said = json["accessors"][part.accessor]
            said["min"], said["max"] = stored.min(axis=0).tolist(), stored.max(axis=0).tolist()
        if part.normals is not None and turned[rows].any():
            _put(part.normals, buffers, unit(new[rows] @ linear), turned[rows])
    error = _error(layout, buffers, mesh.points)
    if error > 4 * max(steps) + 1e-12 * float(np.abs(mesh.points).max(initial=0.0)):
        return None
    notes = (f"coordinates are rounded to the file's own type: by up to {error:.2g}",) if max(steps) > 0 else ()
    companions = _companions(json, file, buffers, path)
    if json == file.json and all(a == b for a, b in zip(buffers, file.buffers, strict=True)):
        return Encoded([carrier.data], companions=companions)
    pretty = not file.binary and b"\n" in file.source.data[:64]
    chunk = buffers[0] if file.binary and buffers else b""
    return Encoded(packed(json, chunk, binary=file.binary, pretty=pretty), (), notes, companions)


def _put(place: Place, buffers: list[bytearray], values: Floats, where: NDArray[np.bool_]) -> float:
    """Store the values that changed; returns how far a stored one may be from the wanted one."""
    if place.dtype.kind in "iu":
        largest = np.iinfo(place.dtype)
        scaled = values * largest.max if place.normalized else values
        typed = np.clip(np.rint(scaled), largest.min, largest.max).astype(place.dtype)
        step = 1 / float(largest.max) if place.normalized else 1.0
    else:
        with np.errstate(over="ignore"):
            typed = values.astype(place.dtype)
        step = float(np.spacing(np.abs(typed).max(initial=0.0)))
    place.view(buffers[place.buffer])[where] = typed[where]
    return step


def _error(layout: Layout, buffers: list[bytearray], points: Floats) -> float:
    """How far the vertices that the buffers now say are from the wanted ones."""
    errors = [0.0]
    for part in layout.parts:
        stored = part.points.view(buffers[part.points.buffer]).astype(np.float64)
        if part.points.normalized and part.points.dtype.kind in "iu":
            stored = np.maximum(stored / float(np.iinfo(part.points.dtype).max), -1.0)
        world = stored @ part.matrix[:3, :3].T + part.matrix[:3, 3]
        errors.append(float(np.abs(world - points[part.first : part.first + part.count]).max(initial=0.0)))
    return max(errors)


def _vertex_normals(mesh: PolygonMesh) -> Floats:
    """(n, 3) one normal a vertex, the mean of those at its corners; zero where there is none."""
    sums = np.zeros_like(mesh.points)
    if mesh.normals is None:
        return sums
    used = mesh.normals.indices >= 0
    if np.array_equal(mesh.normals.indices[used], mesh.faces.flat[used]) and len(mesh.normals.values) == len(sums):
        return mesh.normals.values
    np.add.at(sums, mesh.faces.flat[used], mesh.normals.values[mesh.normals.indices[used]])
    return unit(sums)


def _companions(json: dict[str, Any], file: GltfFile, buffers: list[bytearray], path: Path) -> dict[Path, bytes]:
    """The buffers and pictures that must stand beside the file; the description gets the names that they have."""
    files: dict[Path, bytes] = {}
    for i, said in enumerate(json.get("buffers", [])):
        uri = said.get("uri")
        if uri is None:
            continue
        if uri.startswith("data:"):
            if buffers[i] != file.buffers[i]:
                said["uri"] = uri.partition(",")[0] + "," + base64.b64encode(buffers[i]).decode()
        else:
            said["uri"] = _beside(files, uri, bytes(buffers[i]), path)
    for said in json.get("images", []):
        found = companion(file.source.folder, said.get("uri", "data:"))
        if found is not None:
            said["uri"] = _beside(files, said["uri"], found.read_bytes(), path)
    return {at: data for at, data in files.items() if not (at.is_file() and at.read_bytes() == data)}


def _beside(files: dict[Path, bytes], uri: str, data: bytes, path: Path) -> str:
    """Put a file beside the path; returns the name by which it is found there."""
    name = unquote(uri)
    used = mtl.place(name, data, path.parent, path.stem)
    files[path.parent / used] = data
    return uri if used == name else quote(used)
