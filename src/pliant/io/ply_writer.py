"""Writing PLY: the very same file with other numbers, or a new one, binary and little-endian."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnsupportedFormat
from pliant.io.carrier import Carrier
from pliant.io.colors import as_bytes, is_color
from pliant.io.format import Encoded, Keeps
from pliant.io.losses import color_rounding, losses_of, per_vertex
from pliant.io.ply_body import Column
from pliant.io.ply_layout import NAMES
from pliant.io.text import bytes_of, patched
from pliant.mesh import PolygonMesh
from pliant.numerics.ragged import Ragged

_COLORS = ("red", "green", "blue", "alpha")


@dataclass(frozen=True, eq=False)
class Layout:
    """Where positions and normals stand: a column for each coordinate. ``order`` is the file's byte order."""

    order: str
    points: tuple[Column, ...]
    normals: tuple[Column, ...]


@dataclass(frozen=True, eq=False)
class Lists:
    """Rows of any type, one after another."""

    values: NDArray[Any]
    offsets: NDArray[np.int64]


def same_file(mesh: PolygonMesh, carrier: Carrier) -> Encoded:
    """The file that the mesh was read from with its positions and normals exchanged, in the types that they had."""
    layout: Layout = carrier.layout
    columns = [*layout.points, *layout.normals]
    tables = [(carrier.mesh.points, mesh.points)]
    if layout.normals:
        tables.append((carrier.mesh.vertex_attributes["normals"], mesh.vertex_attributes["normals"]))
    before = [old[:, axis] for old, _ in tables for axis in range(3)]
    after = [new[:, axis] for _, new in tables for axis in range(3)]
    if not layout.order:
        starts = np.stack([np.asarray(column.at) for column in columns], axis=1).ravel()
        return Encoded([patched(carrier.data, starts, np.stack(before, 1).ravel(), np.stack(after, 1).ravel())])
    data = np.frombuffer(carrier.data, np.uint8).copy()
    error = 0.0
    for i, (column, old, new) in enumerate(zip(columns, before, after, strict=True)):
        wrong = _put(data, column, layout.order, old, np.asarray(new, np.float64))
        error = max(error, wrong) if i < 3 else error
    notes = (f"coordinates are rounded to the file's own type: by up to {error:.2g}",) if error else ()
    return Encoded([data.data], notes=notes)


def _put(data: NDArray[np.uint8], column: Column, order: str, old: NDArray[Any], new: NDArray[np.float64]) -> float:
    """Put the values that differ where they stand; returns the largest rounding error."""
    changed = new != old
    if not changed.any():
        return 0.0
    kind = column.values.dtype
    with np.errstate(over="ignore", invalid="ignore"):
        typed = (np.rint(new) if kind.kind in "iu" else new).astype(kind)
        error = float(np.abs(typed - new)[changed].max())
    fits = np.isfinite(error) and (kind.kind == "f" or error <= 0.5)
    if not fits:
        raise UnsupportedFormat(f"the file stores coordinates as {NAMES[kind.str[1:]]}; the new ones do not fit")
    stored = typed.astype(kind.newbyteorder(order))
    if isinstance(column.at, range):
        view = np.ndarray(len(column.at), stored.dtype, data, column.at.start, (column.at.step,))  # type: ignore[arg-type]
        np.copyto(view, stored, where=changed)
    else:
        at = column.at[changed]
        data[at[:, None] + np.arange(kind.itemsize)] = stored[changed].view(np.uint8).reshape(len(at), -1)
    return error


def new_file(mesh: PolygonMesh, keeps: Keeps) -> Encoded:
    """A file written from the mesh alone: float64 positions, everything else in its own type."""
    losses = list(losses_of(mesh, keeps))
    vertex: list[tuple[str, NDArray[Any]]] = [(name, mesh.points[:, axis]) for axis, name in enumerate("xyz")]
    attributes = dict(mesh.vertex_attributes)
    normals = attributes.pop("normals", None)
    if normals is None and mesh.normals is not None and per_vertex(mesh, mesh.normals):
        normals = mesh.normals.values
    if normals is not None:
        vertex += [(name, normals[:, axis]) for axis, name in enumerate(("nx", "ny", "nz"))]
    face: list[tuple[str, Any]] = []
    if mesh.uvs is not None:
        if mesh.uvs.values.shape[1] != 2 or (mesh.uvs.indices < 0).any():
            losses.append("texture coordinates of three components, and corners without any")
        if per_vertex(mesh, mesh.uvs):
            vertex += [(name, mesh.uvs.values[:, axis]) for axis, name in enumerate("st")]
        else:
            values = np.nan_to_num(mesh.uvs.per_corner[:, :2])
            face.append(("texcoord", Lists(values.ravel(), 2 * mesh.faces.offsets)))
    vertex += _columns("vertex", attributes, losses)
    face += _columns("face", dict(mesh.face_attributes), losses)
    head = [b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(mesh.points)]
    parts: list[bytes | memoryview] = []
    lines, body = _table(vertex, len(mesh.points))
    head, parts = [*head, lines], [body]
    if len(mesh.faces) or face:
        polygons = Lists(mesh.faces.flat, mesh.faces.offsets)
        lines, body = _table([("vertex_indices", polygons), *face], len(mesh.faces))
        head, parts = [*head, b"element face %d\n" % len(mesh.faces), lines], [*parts, body]
    if mesh.lines is not None:
        ends, longer = _segments(mesh.lines)
        if longer:
            losses.append(f"{longer:,} lines of more than two points are cut into segments")
        lines, body = _table([("vertex1", ends[:, 0]), ("vertex2", ends[:, 1])], len(ends))
        head, parts = [*head, b"element edge %d\n" % len(ends), lines], [*parts, body]
    return Encoded([b"".join(head) + b"end_header\n", *parts], tuple(losses))


def _columns(element: str, attributes: dict[str, NDArray[Any]], losses: list[str]) -> list[tuple[str, Any]]:
    """Attributes as properties: one each, or a list where a row has several values."""
    result: list[tuple[str, Any]] = []
    for name, values in attributes.items():
        word = bytes_of(name).replace(b" ", b"_").decode("utf-8", "surrogateescape")
        if name == "colors" and is_color(values):
            losses += color_rounding(values)
            result += [(color, as_bytes(values)[:, i]) for i, color in enumerate(_COLORS[: values.shape[1]])]
            continue
        typed = _storable(values)
        if typed is None or not word:
            losses.append(f"the {element} attribute {name!r}, of type {values.dtype}")
        elif typed.ndim == 1:
            result.append((word, typed))
        else:
            flat = typed.reshape(len(typed), -1)
            result.append((word, Lists(flat.ravel(), np.arange(len(flat) + 1) * flat.shape[1])))
    return result


def _storable(values: NDArray[Any]) -> NDArray[Any] | None:
    """The values in a type that PLY has, if one holds them unchanged."""
    if values.dtype.str[1:] in NAMES:
        return values
    for kind in (np.uint8, np.int32, np.uint32, np.float32, np.float64):
        with np.errstate(all="ignore"):
            if values.dtype.kind in "biuf" and np.array_equal(values.astype(kind), values):
                return values.astype(kind)
    return None


def _segments(lines: Ragged) -> tuple[NDArray[np.int32], int]:
    """(e, 2) the ends of the lines' segments, and how many lines have more than one."""
    first = np.ones(len(lines.flat), bool)
    first[lines.offsets[1:][lines.lengths > 0] - 1] = False
    at = np.flatnonzero(first)
    return np.stack([lines.flat[at], lines.flat[at + 1]], axis=1), int((lines.lengths != 2).sum())


def _table(columns: list[tuple[str, Any]], rows: int) -> tuple[bytes, memoryview]:
    """An element's header lines and its body."""
    head, fields, values = [], [], []
    for name, column in columns:
        if isinstance(column, Lists):
            lengths = np.diff(column.offsets)
            count = np.dtype("u1" if lengths.max(initial=0) < 256 else "<i4")
            kind = column.values.dtype.newbyteorder("<")
            head.append(f"property list {NAMES[count.str[1:]]} {NAMES[kind.str[1:]]} {name}\n")
            fields += [count, kind]
            values += [
                Lists(lengths.astype(count), np.arange(rows + 1)),
                Lists(column.values.astype(kind), column.offsets),
            ]
        else:
            kind = column.dtype.newbyteorder("<")
            head.append(f"property {NAMES[kind.str[1:]]} {name}\n")
            fields.append(kind)
            values.append(Lists(column.astype(kind), np.arange(rows + 1)))
    return bytes_of("".join(head)), _packed(values, rows)


def _packed(columns: list[Lists], rows: int) -> memoryview:
    """The rows of all columns, interleaved."""
    lengths = [np.diff(column.offsets) for column in columns]
    if rows and all((each == each[0]).all() for each in lengths):
        shapes = [(column.values.dtype, (int(each[0]),)) for column, each in zip(columns, lengths, strict=True)]
        record = np.empty(rows, np.dtype([(str(i), *shape) for i, shape in enumerate(shapes)]))
        for i, column in enumerate(columns):
            record[str(i)] = column.values.reshape(rows, -1)
        return record.view(np.uint8).data
    sizes = np.stack([each * column.values.itemsize for column, each in zip(columns, lengths, strict=True)])
    ends = np.cumsum(sizes.sum(axis=0))
    body = np.empty(int(ends[-1]) if rows else 0, np.uint8)
    place = ends - sizes.sum(axis=0)
    for column, length, size in zip(columns, lengths, sizes, strict=True):
        width = column.values.itemsize
        at = np.repeat(place - width * column.offsets[:-1], length) + width * np.arange(len(column.values))
        body[at[:, None] + np.arange(width)] = column.values.view(np.uint8).reshape(-1, width)
        place = place + size
    return body.data
