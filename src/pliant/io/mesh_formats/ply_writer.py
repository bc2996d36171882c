"""Writing PLY: the very same file with other numbers, or a new one, binary and little-endian."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnsupportedFormat
from pliant.io.mesh_formats.carrier import Carrier
from pliant.io.mesh_formats.colors import as_bytes, is_color
from pliant.io.mesh_formats.format import Encoded, Keeps
from pliant.io.mesh_formats.losses import color_rounding, losses_of, per_vertex
from pliant.io.mesh_formats.ply_body import Column
from pliant.io.mesh_formats.ply_layout import NAMES
from pliant.io.mesh_formats.ply_packing import Block, Lists, packed
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
    tables = [(layout.points, carrier.mesh.points, mesh.points)]
    if layout.normals:
        new = np.asarray(mesh.vertex_attributes["normals"], np.float64)
        tables.append((layout.normals, carrier.mesh.vertex_attributes["normals"], new))
    if not layout.order:
        starts = np.concatenate([np.asarray(column.at) for columns, _, _ in tables for column in columns])
        before = np.concatenate([old.T.ravel() for _, old, _ in tables])
        after = np.concatenate([new.T.ravel() for _, _, new in tables])
        return Encoded([patched(carrier.data, starts, before, after)])
    data = np.frombuffer(carrier.data, np.uint8).copy()
    errors = [_put(data, *table, layout.order) for table in tables]
    notes = (f"coordinates are rounded to the file's own type: by up to {errors[0]:.2g}",) if errors[0] else ()
    return Encoded([data.data], notes=notes)


def _put(
    data: NDArray[np.uint8],
    columns: tuple[Column, ...],
    old: NDArray[np.float64],
    new: NDArray[np.float64],
    order: Literal["<", ">"],
) -> float:
    """Put the (n, 3) values that differ where they stand; returns the largest rounding error."""
    changed = (new != old) & ~(np.isnan(new) & np.isnan(old))
    if not changed.any():
        return 0.0
    where = True if changed.all() else changed
    beside = _side_by_side(columns)
    if beside is not None:
        typed, error = _typed(new, columns[0].values.dtype, where)
        first, step = beside
        stored = typed.dtype.newbyteorder(order)
        np.copyto(np.ndarray(new.shape, stored, data, first, (step, stored.itemsize)), typed, where=where)
        return error
    errors = [0.0]
    for axis, column in enumerate(columns):
        rows = np.flatnonzero(changed[:, axis])
        typed, error = _typed(new[rows, axis], column.values.dtype, True)
        width = typed.itemsize
        raw = typed.astype(typed.dtype.newbyteorder(order)).view(np.uint8).reshape(-1, width)
        data[np.asarray(column.at)[rows, None] + np.arange(width)] = raw
        errors.append(error)
    return max(errors)


def _side_by_side(columns: tuple[Column, ...]) -> tuple[int, int] | None:
    """Where the first of columns begins that follow each other in every row, and how far the rows are apart."""
    begins = [column.at.start if isinstance(column.at, range) else -1 for column in columns]
    kind = columns[0].values.dtype
    follow = all(begin == begins[0] + kind.itemsize * i for i, begin in enumerate(begins))
    if begins[0] < 0 or not follow or any(column.values.dtype != kind for column in columns):
        return None
    at = columns[0].at
    assert isinstance(at, range)
    return at.start, at.step


def _typed(new: NDArray[np.float64], kind: np.dtype[Any], where: Any) -> tuple[NDArray[Any], float]:
    """Values in a file's type, and the largest rounding error of those that count."""
    with np.errstate(over="ignore", invalid="ignore"):
        typed = (np.rint(new) if kind.kind in "iu" else new).astype(kind)
        error = float(np.abs(typed - new).max(initial=0.0, where=where)) if kind != np.float64 else 0.0
    if not np.isfinite(error) or (kind.kind in "iu" and error > 0.5):
        raise UnsupportedFormat(f"the file stores coordinates as {NAMES[kind.str[1:]]}; the new ones do not fit")
    return typed, error


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
    body = [packed(columns, rows) for _, rows, columns in elements]
    return Encoded([bytes_of("".join([*head, "end_header\n"])), *body], tuple(losses))


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
