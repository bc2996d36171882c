"""Meshes that no memory holds: their points are deformed piece by piece, all else is copied byte for byte.

A run of records of one size, the vertices of a binary PLY file or the triangles of a binary STL file, is cut into
pieces. With a header before it each piece is a small file of the same format, which the format reads and writes as any:
what is true of whole files, such as how normals follow and what rounding is refused, is true of pieces.
"""

from __future__ import annotations

import mmap
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from io import BytesIO
from itertools import product
from pathlib import Path
from typing import Any, BinaryIO, cast

import numpy as np

from pliant.batch.streaming import refuse_surfaces
from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidParameter, UnreadableFile, UnsupportedFormat
from pliant.io.files import replacing
from pliant.io.mesh_formats.format import Source
from pliant.io.mesh_formats.ply_layout import NAMES, Element, Header, parse
from pliant.io.meshes import read_mesh_bytes, write
from pliant.mesh import PolygonMesh
from pliant.scene.stack import Stack

RECORDS = 500_000  # in memory at a time
_STL_HEAD, _STL_RECORD = 84, 50
_AT_ONCE = 1 << 20  # bytes that are copied


@dataclass(frozen=True)
class Run:
    """Records of one size that hold all points of a file.

    Parameters
    ----------
    start, size, count
        At which byte they begin, how many bytes each takes, and how many there are.
    head
        What stands before so many of them in a file of their own.
    """

    start: int
    size: int
    count: int
    head: Callable[[int], bytes]


def stream_mesh(
    deformer: SpaceDeformer | Stack, path: Path | str, output: Path | str, *, records: int = RECORDS
) -> int:
    """Deform a mesh file into another, of which neither need fit into memory.

    Parameters
    ----------
    deformer
        As for :func:`pliant.batch.stream`: a map of space, or a stack of them.
    path
        A binary PLY or STL file.
    output
        Where to, in the same format: positions, and normals that are stored with them, differ; all else is the same.
    records
        How many vertices, or triangles of STL, are in memory at a time.

    Returns
    -------
    int
        How many points there are.

    Raises
    ------
    InvalidTarget
        The deformer needs the whole shape.
    UnsupportedFormat
        The file is text, of another format, or holds lists among its vertices; or the output is to be another format.
    UnreadableFile
        It is cut off, or holds points that are not finite; nothing is written.
    """
    refuse_surfaces(deformer)
    source, target = Path(path), Path(output)
    if source.suffix.lower() != target.suffix.lower():
        raise UnsupportedFormat(f"{target}: pieces of a {source.suffix} file make another: write to {source.suffix}")
    run, points = _run(source), 0
    with source.open("rb") as stream, replacing(target) as temporary, temporary.open("wb") as written:
        _copy(stream, written, run.start)
        for head, mesh in _pieces(run, stream, source, records):
            piece = BytesIO()
            write(deformer(mesh), piece, name=f"piece{source.suffix}")
            written.write(piece.getbuffer()[len(head) :])
            points += len(mesh.points)
        shutil.copyfileobj(stream, written, _AT_ONCE)
    return points


def box_of(path: Path | str, *, records: int = RECORDS) -> PolygonMesh:
    """The corners of the box of a mesh file, read piece by piece: what deformers are laid around.

    Parameters
    ----------
    path, records
        As for :func:`stream_mesh`.

    Returns
    -------
    PolygonMesh
        Eight points, six faces.

    Raises
    ------
    UnsupportedFormat, UnreadableFile
        As for :func:`stream_mesh`; also where the file has no points.
    """
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    with Path(path).open("rb") as stream:
        run = _run(Path(path))
        stream.seek(run.start)
        for _, mesh in _pieces(run, stream, Path(path), records):
            low, high = np.minimum(low, mesh.bounds[0]), np.maximum(high, mesh.bounds[1])
    if not run.count:
        raise UnreadableFile(path, "it has no points", "there is nothing to deform")
    corners = np.array(list(product(*np.stack([low, high], axis=1))))
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return PolygonMesh(corners, faces)  # type: ignore[arg-type]  # rows of corners become polygons


def _pieces(run: Run, stream: BinaryIO, path: Path, records: int) -> Iterator[tuple[bytes, PolygonMesh]]:
    """The head of each piece, and the mesh that it holds."""
    if records < 1:
        raise InvalidParameter(f"{records} records at a time are none: give one or more")
    for first in range(0, run.count, records):
        count = min(records, run.count - first)
        head = run.head(count)
        try:
            mesh = read_mesh_bytes(head + stream.read(count * run.size), path)
        except UnreadableFile as error:
            raise UnreadableFile(path, f"in the piece of {count:,} that begins at {first:,}: {error}") from error
        yield head, mesh


def _run(path: Path) -> Run:
    """Where the points of a file stand."""
    try:
        with path.open("rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data:
            if data[:3] == b"ply":
                return _ply(parse(Source(cast(bytes, data), path)), path)
            return _stl(data, path)
    except (OSError, ValueError) as error:  # ValueError: an empty file cannot be mapped
        raise UnreadableFile(path, getattr(error, "strerror", None) or "the file is empty", "check the path") from error


def _ply(header: Header, path: Path) -> Run:
    start = header.size
    for element in header.elements:
        if not header.order or any(each.count for each in element.properties):
            break
        size = sum(np.dtype(each.type).itemsize for each in element.properties)
        if element.name == "vertex":
            return Run(start, size, element.count, partial(_ply_head, header.order, element))
        start += size * element.count
    why = "has lists before or among its vertices" if header.order else "is text"
    raise UnsupportedFormat(f"{path}: it {why}, and cannot be read in pieces: write it as binary PLY first")


def _ply_head(order: str, vertices: Element, count: int) -> bytes:
    words = [f"property {NAMES[each.type]} {each.name}" for each in vertices.properties]
    first = f"format binary_{'little' if order == '<' else 'big'}_endian 1.0"
    return "\n".join(["ply", first, f"element vertex {count}", *words, "end_header\n"]).encode()


def _stl(data: Any, path: Path) -> Run:
    count = int.from_bytes(data[_STL_HEAD - 4 : _STL_HEAD], "little")
    if len(data) != _STL_HEAD + _STL_RECORD * count or path.suffix.lower() != ".stl":
        raise UnsupportedFormat(f"{path}: only binary PLY and STL files are read in pieces: convert it first")
    name = data[: _STL_HEAD - 4]
    return Run(_STL_HEAD, _STL_RECORD, count, lambda some: name + some.to_bytes(4, "little"))


def _copy(source: BinaryIO, target: BinaryIO, count: int) -> None:
    while count > 0:
        data = source.read(min(count, _AT_ONCE))
        target.write(data)
        count -= len(data) or count
