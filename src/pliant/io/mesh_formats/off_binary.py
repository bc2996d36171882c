"""Binary OFF: big-endian numbers of 32 bits, in the order in which the text form has them."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.io.mesh_formats.format import Source
from pliant.io.mesh_formats.ply_body import Column, decode
from pliant.io.mesh_formats.ply_layout import Element, Header, Property
from pliant.io.mesh_formats.ply_writer import Layout
from pliant.mesh import CornerValues, PolygonMesh
from pliant.numerics.ragged import Ragged

_POINT, _NORMAL, _COLOR, _COORDINATES = ("x", "y", "z"), ("nx", "ny", "nz"), ("r", "g", "b", "a"), ("s", "t")
_LISTS = (Property("corners", "i4", "i4"), Property("color", "f4", "i4"))


def read(source: Source, prefix: bytes, begin: int) -> tuple[PolygonMesh, Layout]:
    """The mesh that follows the header's line, and where its numbers stand.

    Raises
    ------
    UnreadableFile
        The counts are beyond what the file can hold, the file is cut off, or a face uses a vertex that is not there.
    """
    at = source.data.find(b"\n", begin) + 1
    if not at or at + 12 > len(source.data):
        raise source.unreadable("the counts of vertices and faces are missing", "the file is cut off", at=begin)
    vertices, faces, _ = np.frombuffer(source.data, ">i4", 3, at).tolist()
    names = [*_POINT]
    for letter, more in ((b"N", _NORMAL), (b"C", _COLOR), (b"ST", _COORDINATES)):
        names += more if letter in prefix else ()
    if vertices < 0 or faces < 0 or 4 * len(names) * vertices + 8 * faces > len(source.data):
        cause = f"{vertices:,} vertices and {faces:,} faces are announced; the file has {len(source.data):,} bytes"
        raise source.unreadable(cause, "the counts are wrong, or the file is cut off", at=at, text=False)
    properties = tuple(Property(name, "f4") for name in names)
    elements = (Element("vertex", vertices, properties), Element("face", faces, _LISTS))
    columns = decode(source, Header(">", elements, at + 12))
    vertex, face = columns["vertex"], columns["face"]
    for name, column in vertex.items():
        if len(bad := np.flatnonzero(~np.isfinite(column.values))):
            cause = f"vertex {bad[0]} has {name} = {column.values[bad[0]]}"
            raise source.unreadable(cause, "remove or correct it", at=int(column.at[bad[0]]), text=False)
    polygons = _polygons(source, face["corners"], vertices)
    attributes: dict[str, Any] = {}
    if b"N" in prefix:
        attributes["normals"] = _table(vertex, _NORMAL).astype(np.float64)
    if b"C" in prefix:
        attributes["colors"] = _table(vertex, _COLOR)
    mesh = PolygonMesh(
        _table(vertex, _POINT),
        polygons,
        uvs=CornerValues(_table(vertex, _COORDINATES), polygons.flat) if b"ST" in prefix else None,
        vertex_attributes=attributes,
        face_attributes=_painted(face["color"]),
    )
    normals = tuple(vertex[name] for name in _NORMAL) if b"N" in prefix else ()
    return mesh, Layout(">", tuple(vertex[name] for name in _POINT), normals)


def _table(columns: dict[str, Column], names: tuple[str, ...]) -> Any:
    return np.stack([columns[name].values for name in names], axis=1)


def _polygons(source: Source, column: Column, count: int) -> Ragged:
    assert column.offsets is not None
    flat = column.values
    bad = np.flatnonzero((flat < 0) | (flat >= count))
    if len(bad):
        face = int(np.searchsorted(column.offsets, bad[0], "right") - 1)
        cause = f"face {face} uses vertex {flat[bad[0]]}; the file has {count:,} vertices, counted from 0"
        raise source.unreadable(cause, "export the file again", at=int(column.at[face]), text=False)
    return Ragged(flat, column.offsets)


def _painted(column: Column) -> dict[str, Any]:
    """Colours, where every face has one."""
    assert column.offsets is not None
    width = Ragged(np.zeros(len(column.values), np.int32), column.offsets).uniform
    return {"colors": column.values.reshape(-1, width)} if width in (3, 4) else {}
