"""OFF, the Object File Format of Geomview: positions and polygons, with normals, colours or texture coordinates."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.mesh_formats import off_binary, ply_writer
from pliant.io.mesh_formats.carrier import carrier_of, with_carrier
from pliant.io.mesh_formats.colors import as_float, is_color
from pliant.io.mesh_formats.format import Encoded, Keeps, MeshFormat, Source
from pliant.io.mesh_formats.losses import losses_of, per_vertex
from pliant.io.mesh_formats.off_loose import loose_lines
from pliant.io.mesh_formats.ply_writer import Layout as BinaryLayout
from pliant.io.text import Lines, Offsets, count_words, patched, plain_text, ragged_text, read_numbers, rows_text
from pliant.mesh import CornerValues, PolygonMesh
from pliant.numerics.ragged import Ragged

_HEADER = re.compile(rb"(?:\xef\xbb\xbf)?(?:\s++|#[^\r\n]*+)*+((?:ST)?C?N?)(4?n?)OFF(?![A-Za-z0-9_])([ \t]+BINARY)?")


@dataclass(frozen=True, eq=False)
class Layout:
    """Where the numbers stand: (n, 3) offsets of positions, and of normals if there are any."""

    points: Offsets
    normals: Offsets | None


class Off(MeshFormat):
    """OFF with the prefixes ST, C and N, as text or binary."""

    name = "OFF"
    suffixes = (".off", ".coff", ".noff", ".stoff", ".cnoff", ".stcnoff")
    keeps = Keeps(polygons=True, vertex_normals=True, vertex_colors=True, face_colors=True)

    def sniff(self, data: bytes) -> bool:
        """Whether the file begins with OFF or one of its forms."""
        return _HEADER.match(data[:4096]) is not None

    def read(self, source: Source) -> PolygonMesh:
        """The mesh that an OFF file holds."""
        header = _HEADER.match(source.data)
        if header is None:
            raise source.unreadable("the file does not begin with OFF", "check what it is", at=0)
        if header[2]:
            kind = (header[1] + header[2] + b"OFF").decode()
            raise UnsupportedFormat(f"{source.name}: {kind} is not of three dimensions; save it as plain OFF")
        layout: Layout | BinaryLayout
        if header[3]:
            mesh, layout = off_binary.read(source, header[1], header.end())
        else:
            mesh, layout = _text(source, header[1], header.end())
        return with_carrier(mesh, self.name, source.data, layout)

    def encode(self, mesh: PolygonMesh, path: Path) -> Encoded:
        """The file that the mesh was read from, with other numbers; a new one if that was none or another."""
        carrier = carrier_of(mesh, self.name)
        if carrier is None:
            return _new_file(mesh, self.keeps)
        layout: Layout | BinaryLayout = carrier.layout
        if isinstance(layout, BinaryLayout):
            return ply_writer.same_file(mesh, carrier)
        starts, old, new = [layout.points.ravel()], [carrier.mesh.points.ravel()], [mesh.points.ravel()]
        if layout.normals is not None:
            starts.append(layout.normals.ravel())
            old.append(carrier.mesh.vertex_attributes["normals"].ravel())
            new.append(np.asarray(mesh.vertex_attributes["normals"], np.float64).ravel())
        return Encoded([patched(carrier.data, np.concatenate(starts), np.concatenate(old), np.concatenate(new))])


def _text(source: Source, prefix: bytes, begin: int) -> tuple[PolygonMesh, Layout]:
    """The mesh of a text: a vertex or face in each line, or in any layout if that does not add up."""
    text = plain_text(source)
    lines = Lines.of(text, begin)
    try:
        return _mesh(source, prefix, *_counts(source, lines), lines[1:])
    except UnreadableFile:
        least = _needed(prefix)
        loose = loose_lines(source, text, begin, (least + 1, least) if b"C" in prefix else (least,))
        if loose is None:
            raise
        return _mesh(source, prefix, *loose)


def _mesh(source: Source, prefix: bytes, vertices: int, faces: int, body: Lines) -> tuple[PolygonMesh, Layout]:
    if len(body) < vertices + faces:
        cause = f"{vertices + faces:,} lines of vertices and faces are announced; {len(body):,} follow"
        raise source.unreadable(cause, "the file is cut off: copy or export it again", at=len(source.data))
    points, layout, attributes, uvs = _vertices(source, body[:vertices], prefix)
    polygons, colors = _faces(source, body[vertices : vertices + faces], vertices)
    mesh = PolygonMesh(
        points,
        polygons,
        uvs=None if uvs is None else CornerValues(uvs, polygons.flat),
        vertex_attributes=attributes,
        face_attributes=colors,
    )
    return mesh, layout


def _needed(prefix: bytes) -> int:
    """How many numbers a vertex has at least."""
    return 3 + 3 * (b"N" in prefix) + 3 * (b"C" in prefix) + 2 * (b"ST" in prefix)


def _counts(source: Source, lines: Lines) -> tuple[int, int]:
    """The numbers of vertices and faces, no larger than the file could hold."""
    if not len(lines):
        raise source.unreadable("the counts of vertices and faces are missing", "the file is cut off", at=0)
    numbers = read_numbers(source, lines[:1], 2, body=False)
    at = int(lines.start[0])
    vertices, faces = numbers.values
    if numbers.counts[0] < 2 or vertices < 0 or faces < 0 or vertices % 1 or faces % 1:
        raise source.unreadable("the counts of vertices and faces are not two whole numbers", "correct them", at=at)
    if vertices + faces > len(source.data):
        cause = (
            f"{vertices:,.0f} vertices and {faces:,.0f} faces are announced; the file has {len(source.data):,} bytes"
        )
        raise source.unreadable(cause, "correct the counts, or copy the file again", at=at)
    return int(vertices), int(faces)


def _vertices(
    source: Source, lines: Lines, prefix: bytes
) -> tuple[NDArray[np.float64], Layout, dict[str, Any], NDArray[np.float64] | None]:
    """Positions, where they stand, normals and colours by name, and texture coordinates."""
    counts = count_words(source, lines, body=False)
    columns = int(counts.min(initial=len(counts) and 2**31))
    needed = _needed(prefix)
    if len(lines) and columns < needed:
        at = int(lines.start[np.argmin(counts)])
        raise source.unreadable(f"a vertex has {columns} numbers; {needed} are needed", "complete the line", at=at)
    columns = min(max(columns, needed), 12)
    numbers = read_numbers(source, lines, columns, body=False)
    table, starts = numbers.values.reshape(-1, columns), numbers.starts.reshape(-1, columns)
    attributes: dict[str, Any] = {}
    at = 3
    if b"N" in prefix:
        attributes["normals"] = table[:, 3:6]
        at = 6
    last = columns - 2 * (b"ST" in prefix)
    if last - at in (3, 4):  # colours are often there without being announced
        attributes["colors"] = _colors(table[:, at:last])
    uvs = table[:, last:] if b"ST" in prefix else None
    layout = Layout(starts[:, :3], starts[:, 3:6] if b"N" in prefix else None)
    return table[:, :3], layout, attributes, uvs


def _colors(values: NDArray[np.float64]) -> NDArray[Any]:
    """Whole numbers are bytes, all others fractions; fractions are whole only where all are 0 or 1."""
    whole = (values % 1 == 0).all() and values.min(initial=0) >= 0 and values.max(initial=0) <= 255
    return values.astype(np.uint8) if whole and values.max(initial=0) > 1 else values


def _faces(source: Source, lines: Lines, vertices: int) -> tuple[Ragged, dict[str, Any]]:
    """Polygons, and their colours where every face has one."""
    counts = count_words(source, lines, body=False)
    offsets = np.concatenate([[0], np.cumsum(counts)])
    values = read_numbers(source, lines, offsets, body=False).values
    sides = values[offsets[:-1]]
    wrong = np.flatnonzero((sides < 1) | (sides % 1 != 0) | (sides > counts - 1))
    if len(wrong):
        cause = f"face {wrong[0]} announces {sides[wrong[0]]:g} corners; {counts[wrong[0]] - 1} numbers follow"
        raise source.unreadable(cause, "correct the line", at=int(lines.start[wrong[0]]))
    length = sides.astype(np.int64)
    starts = np.concatenate([[0], np.cumsum(length)])
    if len(lines) and (counts == counts[0]).all() and (length == length[0]).all():
        flat = values.reshape(len(lines), -1)[:, 1 : 1 + int(length[0])].reshape(-1)
    else:
        flat = values[np.repeat(offsets[:-1] + 1 - starts[:-1], length) + np.arange(starts[-1])]
    bad = np.flatnonzero((flat < 0) | (flat >= vertices) | (flat % 1 != 0))
    if len(bad):
        face = int(np.searchsorted(starts, bad[0], "right") - 1)
        cause = f"face {face} uses vertex {flat[bad[0]]:g}; the file has {vertices:,} vertices, counted from 0"
        raise source.unreadable(cause, "correct the line", at=int(lines.start[face]))
    rest = counts - 1 - length
    colors: dict[str, Any] = {}
    if len(rest) and rest[0] in (3, 4) and (rest == rest[0]).all():
        colors["colors"] = _colors(values[(offsets[1:] - rest[0])[:, None] + np.arange(rest[0])])
    return Ragged(flat.astype(np.int32), starts), colors


def _new_file(mesh: PolygonMesh, keeps: Keeps) -> Encoded:
    prefix, columns = b"", [mesh.points]
    normals = mesh.vertex_attributes.get("normals")
    if normals is None and mesh.normals is not None and per_vertex(mesh, mesh.normals):
        normals = mesh.normals.values
    if normals is not None:
        prefix, columns = b"N", [*columns, np.asarray(normals, np.float64)]
    colors = mesh.vertex_attributes.get("colors")
    if colors is not None and is_color(colors):
        prefix, columns = b"C" + prefix, [*columns, as_float(colors)]
    losses = losses_of(mesh, keeps)
    if mesh.uvs is not None and per_vertex(mesh, mesh.uvs) and mesh.uvs.values.shape[1] == 2:
        prefix, columns = b"ST" + prefix, [*columns, mesh.uvs.values]
        losses = tuple(loss for loss in losses if not loss.endswith("texture coordinates"))
    head = prefix + b"OFF\n%d %d 0\n" % (len(mesh.points), len(mesh.faces))
    faces = ragged_text(mesh.faces, counted=True)
    painted = mesh.face_attributes.get("colors")
    if painted is not None and is_color(painted):
        paint = rows_text(as_float(painted)).splitlines()
        faces = b"".join(b"%b %b\n" % pair for pair in zip(faces.splitlines(), paint, strict=True))
    return Encoded([head, rows_text(np.hstack(columns)), faces], losses)
