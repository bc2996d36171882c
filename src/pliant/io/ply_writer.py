"""Writing PLY: the very same file with other numbers, or a new one, binary and little-endian."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

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

    order: Literal["", "<", ">"]
    points: tuple[Column, ...]
    normals: tuple[Column, ...]


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


def _put(
    data: NDArray[np.uint8], column: Column, order: Literal["<", ">"], old: NDArray[Any], new: NDArray[np.float64]
) -> float:
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
        view = np.ndarray(len(column.at), stored.dtype, data, column.at.start, (column.at.step,))
        np.copyto(view, stored, where=changed)
    else:
        at = column.at[changed]
        data[at[:, None] + np.arange(kind.itemsize)] = stored[changed].view(np.uint8).reshape(len(at), -1)
    return error


def new_file(mesh: PolygonMesh, keeps: Keeps) -> Encoded:
    """A file written from the mesh alone: float64 positions, everything else in its own type."""
    losses = list(losses_of(mesh, keeps))
    vertex: list[Block | Lists] = [Block(("x", "y", "z"), mesh.points)]
    face: list[Block | Lists] = []
    attributes = dict(mesh.vertex_attributes)
    normals = attributes.pop("normals", None)
    if normals is None and mesh.normals is not None and per_vertex(mesh, mesh.normals):
        normals = mesh.normals.values
    if normals is not None:
        vertex.append(Block(("nx", "ny", "nz"), normals))
    if mesh.uvs is not None:
        if mesh.uvs.values.shape[1] != 2 or (mesh.uvs.indices < 0).any():
            losses.append("texture coordinates of three components, and corners without any")
        if per_vertex(mesh, mesh.uvs):
            vertex.append(Block(("s", "t"), mesh.uvs.values[:, :2]))
        else:
            face.append(Lists("texcoord", np.nan_to_num(mesh.uvs.per_corner[:, :2]).ravel(), 2 * mesh.faces.offsets))
    vertex += _properties("vertex", attributes, losses)
    face += _properties("face", dict(mesh.face_attributes), losses)
    elements = [("vertex", len(mesh.points), vertex)]
    if len(mesh.faces) or face:
        polygons = Lists("vertex_indices", mesh.faces.flat, mesh.faces.offsets)
        elements.append(("face", len(mesh.faces), [polygons, *face]))
    if mesh.lines is not None:
        ends, longer = _segments(mesh.lines)
        if longer:
            losses.append(f"{longer:,} lines of more than two points are cut into segments")
        elements.append(("edge", len(ends), [Block(("vertex1", "vertex2"), ends)]))
    head = ["ply\nformat binary_little_endian 1.0\n"]
    for name, rows, columns in elements:
        head += [f"element {name} {rows}\n", *(column.header() for column in columns)]
    body = [_packed(columns, rows) for _, rows, columns in elements]
    return Encoded([bytes_of("".join([*head, "end_header\n"])), *body], tuple(losses))


@dataclass(frozen=True, eq=False)
class Block:
    """Properties of one type side by side: (n, d) values."""

    names: tuple[str, ...]
    values: NDArray[Any]

    def header(self) -> str:
        """The lines that declare it."""
        return "".join(f"property {NAMES[self.values.dtype.str[1:]]} {name}\n" for name in self.names)


@dataclass(frozen=True, eq=False)
class Lists:
    """A property whose rows are lists, one after another."""

    name: str
    values: NDArray[Any]
    offsets: NDArray[np.int64]

    @cached_property
    def lengths(self) -> NDArray[np.int64]:
        """How long each list is."""
        return np.diff(self.offsets)

    @cached_property
    def count(self) -> np.dtype[Any]:
        """The type that lengths are stored in."""
        return np.dtype("u1" if self.lengths.max(initial=0) < 256 else "<i4")

    def header(self) -> str:
        """The line that declares it."""
        return f"property list {NAMES[self.count.str[1:]]} {NAMES[self.values.dtype.str[1:]]} {self.name}\n"


def _properties(element: str, attributes: dict[str, NDArray[Any]], losses: list[str]) -> list[Block | Lists]:
    """Attributes as properties: one each, or a list where a row has several values."""
    result: list[Block | Lists] = []
    for name, values in attributes.items():
        word = "_".join(name.split())
        typed = _storable(values)
        if name == "colors" and is_color(values):
            losses += color_rounding(values)
            result.append(Block(_COLORS[: values.shape[1]], as_bytes(values)))
        elif typed is None or not word:
            losses.append(f"the {element} attribute {name!r}, of type {values.dtype}")
        elif typed.ndim == 1:
            result.append(Block((word,), typed[:, None]))
        else:
            flat = typed.reshape(len(typed), math.prod(typed.shape[1:]))
            result.append(Lists(word, flat.ravel(), np.arange(len(flat) + 1) * flat.shape[1]))
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


def _packed(columns: list[Block | Lists], rows: int) -> memoryview:
    """The rows of all columns, interleaved."""
    lists = [column for column in columns if isinstance(column, Lists)]
    if rows and all((column.lengths == column.lengths[0]).all() for column in lists):
        return _packed_alike(columns, rows)
    pieces = []  # (values, how many a row) of each count, list and block
    for column in columns:
        if isinstance(column, Lists):
            pieces.append((column.lengths.astype(column.count), np.ones(rows, np.int64)))
            pieces.append((_little(column.values), column.lengths))
        else:
            pieces.append((_little(column.values).ravel(), np.full(rows, column.values.shape[1])))
    sizes = [length * values.itemsize for values, length in pieces]
    ends = np.cumsum(np.sum(sizes, axis=0))
    body = np.empty(int(ends[-1]) if rows else 0, np.uint8)
    place = ends - np.sum(sizes, axis=0)
    for (values, length), size in zip(pieces, sizes, strict=True):
        width = values.itemsize
        at = np.repeat(place - width * (np.cumsum(length) - length), length) + width * np.arange(len(values))
        body[at[:, None] + np.arange(width)] = np.ascontiguousarray(values).view(np.uint8).reshape(-1, width)
        place = place + size
    return body.data


def _packed_alike(columns: list[Block | Lists], rows: int) -> memoryview:
    """The rows of columns whose lists are all of one length."""
    fields: list[tuple[str, Any, tuple[int, ...]]] = []
    for i, column in enumerate(columns):
        width = column.values.shape[1] if isinstance(column, Block) else int(column.lengths[0])
        if isinstance(column, Lists):
            fields.append((f"count{i}", column.count, ()))
        fields.append((f"values{i}", column.values.dtype.newbyteorder("<"), (width,)))
    record = np.empty(rows, np.dtype(fields))
    for i, column in enumerate(columns):
        if isinstance(column, Lists):
            record[f"count{i}"] = column.lengths[0]
        record[f"values{i}"] = column.values.reshape(rows, -1)
    return record.view(np.uint8).data


def _little(values: NDArray[Any]) -> NDArray[Any]:
    return np.asarray(values, values.dtype.newbyteorder("<"))
