"""STL, binary and as text: loose triangles, three points each, in single precision when binary.

STL has no shared vertices, and none are made up here: a mesh that was read has three points a triangle, in file order.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.io.mesh_formats.carrier import Carrier, carrier_of, with_carrier
from pliant.io.mesh_formats.format import Encoded, Keeps, MeshFormat, Source
from pliant.io.mesh_formats.losses import as_float32, losses_of
from pliant.io.text import Lines, Offsets, patched, plain_text, read_numbers, text_of
from pliant.mesh import FaceLabels, PolygonMesh
from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.ragged import Ragged

_RECORD = np.dtype([("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("attribute", "<u2")])
_HEAD = 84
_CHUNK = 8_192  # triangles at a time, so that what lies between stays in cache
_TEXT = re.compile(rb"(?i)(?:\xef\xbb\xbf)?\s*solid\b[^\r\n]*[\r\n]\s*+(?:facet|endsolid)\b")
_ORDER = re.compile(r"(?:s(?:flvvvep)*t)+")  # the words below, a letter each
_WORDS = {
    b"solid": "s", b"facet": "f", b"outer": "l", b"vertex": "v", b"endloop": "e", b"endfacet": "p", b"endsolid": "t",
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Layout:
    """Where the numbers of a text file stand: (3t, 3) of points and (t, 3) of normals, whose values it has too."""

    points: Offsets
    normals: Offsets
    values: NDArray[np.float64]


class Stl(MeshFormat):
    """STL; written as binary, or as text where it was read as text."""

    name = "STL"
    suffixes = (".stl",)
    keeps = Keeps(shared_vertices=False, precision="float32")

    def sniff(self, data: bytes) -> bool:
        """Whether the length fits the header's count, or the text begins as STL does."""
        return _fits_binary(data) or _TEXT.match(data[:4096]) is not None

    def read(self, source: Source) -> PolygonMesh:
        """The mesh that an STL file holds."""
        if not _fits_binary(source.data) and source.data[:512].lower().lstrip(b"\xef\xbb\xbf \t\r\n").startswith(
            b"solid"
        ):
            return _read_text(source)
        return _read_binary(source)

    def encode(self, mesh: PolygonMesh, path: Path) -> Encoded:
        """The file that the mesh was read from, with other numbers; a new one if that was none or another."""
        carrier = carrier_of(mesh, self.name)
        if carrier is None:
            return _new_file(mesh, self.keeps)
        return _same_text(mesh, carrier) if carrier.layout else _same_binary(mesh, carrier)


def _fits_binary(data: bytes) -> bool:
    """Whether the length is that of as many triangles as the header announces, whatever it begins with."""
    return len(data) >= _HEAD and len(data) == _HEAD + _RECORD.itemsize * int.from_bytes(data[80:84], "little")


def _read_binary(source: Source) -> PolygonMesh:
    data = source.data
    if not _fits_binary(data):
        count = int.from_bytes(data[80:84], "little")
        cause = f"{count:,} triangles need {_HEAD + _RECORD.itemsize * count:,} bytes; the file has {len(data):,}"
        cause = cause if len(data) >= _HEAD else f"an STL file has at least {_HEAD} bytes; this one {len(data)}"
        raise source.unreadable(cause, "the file is cut off or is no STL: export it again", at=80, text=False)
    records = np.frombuffer(data, _RECORD, offset=_HEAD)
    points = records["points"].reshape(-1, 3).astype(np.float64)
    if not np.isfinite(points).all():
        at = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        place = _HEAD + _RECORD.itemsize * (at // 3) + 12 + 12 * (at % 3)
        raise source.unreadable(f"triangle {at // 3} has a corner at {points[at]}", "remove it", at=place, text=False)
    used = records["attribute"].any()
    attributes = {"attribute": records["attribute"]} if used else {}
    mesh = PolygonMesh(points, _triples(len(records)), face_attributes=attributes)
    return with_carrier(mesh, Stl.name, data, None)


def _triples(count: int) -> Ragged:
    return Ragged.of(np.arange(3 * count, dtype=np.int32).reshape(count, 3))


def _read_text(source: Source) -> PolygonMesh:
    lines = Lines.of(plain_text(source))
    rows = {letter: lines.where(word) for word, letter in _WORDS.items()}
    letters = np.full(len(lines), ord("?"), np.uint8)
    for letter, at in rows.items():
        letters[at] = ord(letter)
    order = letters.tobytes().decode()
    fitting = _ORDER.match(order)
    if fitting is None or fitting.end() != len(order):
        _explain_order(source, lines, order)
    corners = read_numbers(source, lines[rows["v"]], 3)
    facets = lines[rows["f"]]
    words = read_numbers(source, _after(facets, b"normal"), 3)
    short = np.concatenate([lines.start[rows["v"]][corners.counts < 3], facets.start[words.counts < 3]])
    if len(short):
        raise source.unreadable("three numbers are needed", "complete the line", at=int(short.min()))
    names = [text_of(lines.rest(row)) for row in rows["s"]]
    solid = np.searchsorted(rows["s"], rows["f"]) - 1
    labels = FaceLabels(*_unique(names, solid)) if len(names) > 1 or names[0] else None
    mesh = PolygonMesh(corners.values.reshape(-1, 3), _triples(len(facets)), objects=labels)
    layout = Layout(corners.starts.reshape(-1, 3), words.starts.reshape(-1, 3), words.values.reshape(-1, 3))
    return with_carrier(mesh, Stl.name, source.data, layout)


def _unique(names: list[str], indices: NDArray[np.int64]) -> tuple[tuple[str, ...], NDArray[np.int32]]:
    ids: dict[str, int] = {}
    table = np.array([ids.setdefault(name, len(ids)) for name in names], np.int32)
    return tuple(ids), table[indices]


def _after(facets: Lines, word: bytes) -> Lines:
    """The lines with their bodies moved behind a second word, where they have it."""
    bodies = facets.body.copy()
    if len(bodies):
        window = np.frombuffer(facets.text + b" " * 16, np.uint8)
        while len(blank := np.flatnonzero((window[bodies] <= 32) & (bodies < facets.end))):
            bodies[blank] += 1
        letters = window[bodies[:, None] + np.arange(len(word))] | 32
        bodies[(letters == np.frombuffer(word, np.uint8)).all(axis=1)] += len(word)
    return Lines(facets.text, facets.start, bodies, facets.end, facets.key)


def _explain_order(source: Source, lines: Lines, order: str) -> None:
    """Say where the statements leave the order that triangles have."""
    good = re.match(r"(?:s(?:flvvvep)*t)*(?:s(?:flvvvep)*)?(?:f(?:l(?:vvve|v{0,3}))?)?", order)
    at = good.end() if good else 0
    cause = "the file ends within a solid" if at == len(order) else "a statement is out of order"
    place = len(source.data) if at == len(order) else int(lines.start[at])
    cure = "facet, outer loop, three vertices, endloop, endfacet are needed; the file may be cut off: export it again"
    raise source.unreadable(cause, cure, at=place)


def _columns(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """(3, 3, t) coordinate by corner by triangle of (t, 9) or (t, 3, 3) corners: how arithmetic on many is fast."""
    return np.ascontiguousarray(corners.reshape(-1, 3, 3).transpose(2, 1, 0))


def _normals(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """(t, 3) unit normals of (3, 3, t) corners; zero for triangles without area."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normals = np.empty_like(a)
    for axis, (i, j) in enumerate(((1, 2), (2, 0), (0, 1))):
        normals[axis] = a[i] * b[j] - a[j] * b[i]
    size = np.sqrt((normals * normals).sum(axis=0))
    size[size == 0] = 1.0
    normals /= size
    return normals.T


def _same_binary(mesh: PolygonMesh, carrier: Carrier) -> Encoded:
    old, new = carrier.mesh.points.reshape(-1, 9), mesh.points.reshape(-1, 9)
    _, notes = as_float32(mesh.points, Stl.name)
    data = np.frombuffer(carrier.data, np.uint8).copy()
    records = data[_HEAD:].view(_RECORD)

    def work(first: int, stop: int) -> None:
        changed = first + np.flatnonzero((old[first:stop] != new[first:stop]).any(axis=1))
        if len(changed):
            at = slice(first, stop) if len(changed) == stop - first else changed
            records["points"][at] = new[at].reshape(-1, 3, 3)
            records["normal"][at] = _normals(_columns(new[at]))

    for_chunks(work, len(records), _CHUNK)
    return Encoded([data.data], notes=notes)


def _same_text(mesh: PolygonMesh, carrier: Carrier) -> Encoded:
    layout: Layout = carrier.layout
    changed = (mesh.points != carrier.mesh.points).reshape(-1, 9).any(axis=1)
    normals = layout.values.copy()
    normals[changed] = _normals(_columns(mesh.points.reshape(-1, 9)[changed]))
    starts = np.concatenate([layout.points.ravel(), layout.normals.ravel()])
    old = np.concatenate([carrier.mesh.points.ravel(), layout.values.ravel()])
    return Encoded([patched(carrier.data, starts, old, np.concatenate([mesh.points.ravel(), normals.ravel()]))])


def _new_file(mesh: PolygonMesh, keeps: Keeps) -> Encoded:
    _, rounding = as_float32(mesh.points, Stl.name)
    triangles = mesh.faces.flat.reshape(-1, 3) if mesh.faces.uniform == 3 else mesh.triangles
    records = np.zeros(len(triangles), _RECORD)
    columns = np.ascontiguousarray(mesh.points.T)

    def work(first: int, stop: int) -> None:
        corners = np.take(columns, triangles[first:stop].T, axis=1)
        records["points"][first:stop] = corners.T
        records["normal"][first:stop] = _normals(corners)

    for_chunks(work, len(triangles), _CHUNK)
    known: tuple[str, ...] = ()
    attribute = mesh.face_attributes.get("attribute")
    if attribute is not None and attribute.dtype == np.uint16:
        known, records["attribute"] = ("attribute",), attribute[mesh.triangle_faces]
    head = b"binary STL".ljust(80, b" ") + len(records).to_bytes(4, "little")
    return Encoded([head, records.view(np.uint8).data], (*losses_of(mesh, keeps, known_faces=known), *rounding))
