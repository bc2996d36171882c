"""Writing Wavefront OBJ: the very same file with other numbers, or a new one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import orjson
from numpy.typing import NDArray

from pliant.io.mesh_formats import mtl
from pliant.io.mesh_formats.carrier import Carrier
from pliant.io.mesh_formats.colors import as_float
from pliant.io.mesh_formats.format import Encoded, MeshFormat, Source
from pliant.io.mesh_formats.losses import losses_of
from pliant.io.mesh_formats.obj_elements import parse_elements
from pliant.io.mesh_formats.obj_names import writable_names
from pliant.io.text import (
    Lines,
    Offsets,
    bytes_of,
    number_text,
    patched,
    plain_text,
    ragged_text,
    rows_text,
    shown,
    spliced,
)
from pliant.mesh import CornerValues, PolygonMesh
from pliant.numerics.ragged import Ragged


@dataclass(frozen=True, eq=False)
class Layout:
    """Where an OBJ file's numbers stand, and the libraries that it uses.

    ``points`` and ``normals`` are (n, 3) and (k, 3) offsets; ``pool`` the file's normals, used or not.
    """

    points: Offsets
    pool: NDArray[np.float64]
    normals: Offsets
    libraries: tuple[mtl.Library, ...]


def same_file(mesh: PolygonMesh, carrier: Carrier, path: Path) -> Encoded:
    """The file that the mesh was read from with its positions and normals exchanged."""
    layout: Layout = carrier.layout
    files, renamed, missing = mtl.gather(list(layout.libraries), path)
    old, new = carrier.mesh.normals, mesh.normals
    kept = (
        old is None or new is None or (len(new.values) == len(old.values) and np.array_equal(new.indices, old.indices))
    )
    data: bytes | memoryview
    if kept:
        values = [mesh.points.ravel()] if new is None else [mesh.points.ravel(), new.values.ravel()]
        before = [carrier.mesh.points.ravel()] if old is None else [carrier.mesh.points.ravel(), old.values.ravel()]
        starts = [layout.points.ravel()] if new is None else [layout.points.ravel(), layout.normals.ravel()]
        data = patched(carrier.data, np.concatenate(starts), np.concatenate(before), np.concatenate(values))
    else:
        data = _with_normals(mesh, carrier)
    if renamed:
        data = _renamed(bytes(data), renamed)
    return Encoded([data], notes=_notes(missing), companions=files)


def _with_normals(mesh: PolygonMesh, carrier: Carrier) -> memoryview:
    """Another pool of normals: more 'vn' lines behind the last one, and other normal indices in the 'f' lines."""
    layout: Layout = carrier.layout
    normals = mesh.normals
    assert normals is not None
    source = Source(carrier.data, "the file read before")
    lines = Lines.of(plain_text(source))
    _, at, _ = parse_elements(source, lines[lines.where(b"f", b"fo")])
    known = len(layout.pool)
    kept = min(known, len(normals.values))
    pieces = number_text(mesh.points).split(b",") + number_text(normals.values[:kept]).split(b",")
    end = b"\r\n" if b"\r\n" in carrier.data else b"\n"
    more = rows_text(normals.values[known:], b"vn ").replace(b"\n", end)
    used = normals.indices >= 0
    starts = np.concatenate([layout.points.ravel(), layout.normals[:kept].ravel(), at[used]])
    pieces += number_text(normals.indices[used] + 1).split(b",")
    if more:
        last = 3 * len(mesh.points) + 3 * known - 1
        pieces[last] += end + more[: -len(end)]
    unchanged = np.flatnonzero(mesh.points.ravel() == carrier.mesh.points.ravel())
    keep = np.ones(len(starts), bool)
    keep[unchanged] = False
    order = np.flatnonzero(keep)[np.argsort(starts[keep], kind="stable")]
    return spliced(carrier.data, starts[order], b",".join(map(pieces.__getitem__, order.tolist())))


def _renamed(data: bytes, renamed: dict[str, str]) -> bytes:
    """The 'mtllib' lines with other names."""
    lines = Lines.of(data)
    for row in lines.where(b"mtllib")[::-1]:
        begin, end = int(lines.body[row]), int(lines.end[row])
        rest = data[begin:end]
        for old, new in renamed.items():
            rest = rest.replace(bytes_of(old), bytes_of(new))
        data = data[:begin] + rest + data[end:]
    return data


def _notes(missing: list[str]) -> tuple[str, ...]:
    return tuple(f"the picture {shown(name)!r} that a material names was not found" for name in missing)


def new_file(given: PolygonMesh, target: MeshFormat, path: Path) -> Encoded:
    """A file written from the mesh alone."""
    mesh, losses = writable_names(given)
    parts: list[bytes] = []
    files: dict[Path, bytes] = {}
    notes: tuple[str, ...] = ()
    if mesh.material_library:
        folder = mesh.source.parent if mesh.source else Path()
        name = path.stem.replace(" ", "_") + ".mtl"
        library = mtl.Library(name, folder / name, mtl.text(mesh.material_library))
        files, renamed, missing = mtl.gather([library], path)
        notes = _notes(missing)
        parts.append(b"mtllib " + bytes_of(renamed.get(name, name)) + b"\n")
    colors = mesh.vertex_attributes.get("colors")
    table = mesh.points if colors is None else np.hstack([mesh.points, as_float(colors)])
    parts.append(rows_text(table, b"v "))
    if mesh.uvs is not None:
        parts.append(rows_text(mesh.uvs.values, b"vt "))
    normals = mesh.normals
    if normals is None and "normals" in mesh.vertex_attributes:
        normals = CornerValues(mesh.vertex_attributes["normals"], mesh.faces.flat)
    if normals is not None:
        parts.append(rows_text(normals.values, b"vn "))
    parts += _faces(mesh, normals)
    if mesh.lines is not None:
        parts.append(ragged_text(Ragged(mesh.lines.flat + 1, mesh.lines.offsets), b"l "))
    losses += losses_of(mesh, target.keeps, known_faces=("smoothing",))
    return Encoded(parts, losses, notes, files)


def _faces(mesh: PolygonMesh, normals: CornerValues | None) -> list[bytes]:
    """The 'f' lines, with a statement wherever the object, group, material or smoothing changes."""
    text = _face_lines(mesh.faces, mesh.uvs, normals)
    states: list[tuple[bytes, NDArray[np.int32], list[bytes]]] = []
    for word, labels in ((b"o", mesh.objects), (b"g", mesh.groups), (b"usemtl", mesh.materials)):
        if labels is not None:
            states.append((word, labels.indices, [bytes_of(name) for name in labels.names]))
    if "smoothing" in mesh.face_attributes:
        numbers, which = np.unique(mesh.face_attributes["smoothing"], return_inverse=True)
        states.append((b"s", which.astype(np.int32), [b"%d" % number for number in numbers]))
    if not states or not len(mesh.faces):
        return [text]
    ends = np.flatnonzero(np.frombuffer(text, np.uint8) == 10) + 1
    changes = [np.flatnonzero(np.diff(indices, prepend=-1)) for _, indices, _ in states]
    starts = np.unique(np.concatenate([[0], *changes]))
    parts, before = [], [-1] * len(states)
    for begin, stop in zip(starts, [*starts[1:], len(mesh.faces)], strict=True):
        for i, (word, indices, names) in enumerate(states):
            now = int(indices[begin])
            if now != before[i]:
                parts.append((word + b" " + (names[now] if now >= 0 else b"")).rstrip() + b"\n")
                before[i] = now
        parts.append(text[ends[begin - 1] if begin else 0 : ends[stop - 1]])
    return parts


def _face_lines(faces: Ragged, uvs: CornerValues | None, normals: CornerValues | None) -> bytes:
    if not len(faces):
        return b""
    if uvs is None and normals is None:
        return ragged_text(Ragged(faces.flat + 1, faces.offsets), b"f ")
    columns = [faces.flat, *(values.indices for values in (uvs, normals) if values is not None)]
    corners = np.stack(columns, axis=1) + 1
    if faces.uniform:
        text = _json(corners.reshape(len(faces), faces.uniform, -1))[3:-3].replace(b"]],[[", b"\nf ")
    else:
        mark = _json(np.zeros((1, corners.shape[1]), np.int32))[1:-1]  # a row of zeros begins each face
        text = _json(np.insert(corners, faces.offsets[:-1], 0, axis=0))[2 + len(mark) + 1 : -2]
        text = text.replace(b"]," + mark + b",[", b"\nf ")
    text = b"f " + text.replace(b"],[", b" ").replace(b",", b"//" if uvs is None else b"/") + b"\n"
    if (corners == 0).any():
        for empty, none in ((b"/0/", b"//"), (b"/0 ", b" "), (b"/0\n", b"\n"), (b"/ ", b" "), (b"/\n", b"\n")):
            text = text.replace(empty, none)
        text = text.replace(b"/ ", b" ").replace(b"/\n", b"\n")
    return text


def _json(values: NDArray[np.int32]) -> bytes:
    return orjson.dumps(np.ascontiguousarray(values), option=orjson.OPT_SERIALIZE_NUMPY)
