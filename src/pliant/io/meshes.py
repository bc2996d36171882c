"""Reading and writing meshes: which format a file has, and what all formats share.

A format is one module and one line of the table below; it is imported when it is first needed.
"""

from __future__ import annotations

import gzip
from collections.abc import Iterator
from dataclasses import asdict
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from pliant.errors import InvalidMesh, UnreadableFile, UnsupportedFormat
from pliant.io.files import read_bytes, write_bytes
from pliant.io.gzipped import inflated, is_gzipped
from pliant.io.mesh_formats.carrier import Carrier
from pliant.io.mesh_formats.format import MeshFormat, Source
from pliant.io.report import LossReport, refuse_losses
from pliant.mesh import PolygonMesh

_FORMATS = {  # module and class by ending; files are recognised in this order
    "pliant.io.mesh_formats.ply:Ply": (".ply",),
    "pliant.io.mesh_formats.gltf:Gltf": (".glb", ".gltf"),
    "pliant.io.mesh_formats.polydata:PolyData": (".vtp", ".vtk"),
    "pliant.io.mesh_formats.unstructured:Unstructured": (".vtu", ".vtk"),
    "pliant.io.mesh_formats.vtk_grid:VtkGrid": (".vti", ".vtr", ".vts"),
    "pliant.io.mesh_formats.gmsh:Gmsh": (".msh",),
    "pliant.io.mesh_formats.threemf:ThreeMf": (".3mf",),
    "pliant.io.mesh_formats.off:Off": (".off", ".coff", ".noff", ".stoff", ".cnoff", ".stcnoff"),
    "pliant.io.mesh_formats.stl:Stl": (".stl",),
    "pliant.io.mesh_formats.obj:Obj": (".obj",),
    "pliant.io.mesh_formats.point_table:PointTable": (".xyz", ".csv"),
}


_ROOM, _GROWTH = 1 << 26, 100  # bytes that any compressed file may inflate to, and how often its own size


def read(file: Path | str | BinaryIO, *, name: str | None = None, freeze: bool = False) -> PolygonMesh:
    """Read a mesh; its format is recognised by what the file holds, and by its ending only where that says nothing.

    Parameters
    ----------
    file
        A path, or a binary stream, which is read to its end; compressed by gzip or not. Files that a stream refers
        to are not looked for.
    name
        What errors call a stream, and what its ending is taken from; its own name if it has one.
    freeze
        Read a shape at rest, which a skin or morph targets would move, instead of refusing it.

    Raises
    ------
    UnreadableFile
        The file is not there, is cut off or contradicts itself; the line or byte, the cause and the cure are named.
    UnsupportedFormat
        The file is of no format that pliant reads.
    """
    if isinstance(file, (str, Path)):
        path = Path(file)
        return read_mesh_bytes(read_bytes(path), name or path, folder=path.parent, freeze=freeze)
    data = file.read()
    known = name or _stream_name(file)
    if not isinstance(data, bytes):
        raise UnreadableFile(known, "the stream gives text", "open it as binary: open(path, 'rb')")
    if not data:
        raise UnreadableFile(known, "the stream is empty", "rewind it: stream.seek(0)")
    return read_mesh_bytes(data, known, freeze=freeze)


def read_mesh_bytes(data: bytes, name: Path | str, *, folder: Path | None = None, freeze: bool = False) -> PolygonMesh:
    """A mesh from the bytes of a file.

    Parameters
    ----------
    data
        The whole file, compressed by gzip or not.
    name
        What errors call it; its ending counts where the bytes do not say what they are.
    folder
        Where files that it refers to are looked for; None: nowhere.
    freeze
        As :func:`read`.

    Raises
    ------
    UnreadableFile, UnsupportedFormat
        As :func:`read`.
    """
    source = Source(_inflated(data, name), _plain(name), folder, freeze)
    try:
        mesh = _recognised(source).read(source)
    except InvalidMesh as error:
        raise source.unreadable(str(error), "repair the file, or export it again") from error
    return mesh.replace(source=Path(name))


def write(
    mesh: PolygonMesh, file: Path | str | BinaryIO, *, name: str | None = None, strict: bool = False
) -> LossReport:
    """Write a mesh in the format that the ending names; a further ``.gz`` compresses it.

    A mesh written in the format that it was read from differs in its positions, and in stored normals, only.

    Parameters
    ----------
    mesh
        The mesh.
    file
        Where to: a path, whose file is replaced once the new one is complete, or a binary stream.
    name
        Whose ending names the format of a stream.
    strict
        Refuse to write what the format cannot hold in full.

    Returns
    -------
    LossReport
        What the format could not hold.

    Raises
    ------
    UnsupportedFormat
        No format has this ending, or the format cannot hold the mesh at all.
    LossRefused
        Something would be lost, and ``strict`` is set; nothing is written.
    """
    path = file if isinstance(file, Path) else Path(file if isinstance(file, str) else name or _stream_name(file))
    plain = path.with_suffix("") if path.suffix.lower() == ".gz" else path
    target = _writer(plain, mesh)
    empty = np.flatnonzero(mesh.faces.lengths == 0)
    if len(empty):
        raise UnsupportedFormat(f"face {empty[0]} has no corners, and no file can say so: remove it")
    encoded = target.encode(mesh, plain)
    parts = [gzip.compress(b"".join(encoded.parts), 6, mtime=0)] if plain != path else encoded.parts
    if isinstance(file, (str, Path)):
        refuse_losses(encoded.losses, path, strict=strict)
        for companion, data in encoded.companions.items():
            write_bytes(companion, data)
        write_bytes(path, parts)
        return LossReport(path, target.name, encoded.losses, encoded.notes)
    losses = (*encoded.losses, *(f"the file {each.name!r} that belongs beside it" for each in encoded.companions))
    refuse_losses(losses, path, strict=strict)
    file.writelines(parts)
    return LossReport(path, target.name, losses, encoded.notes)


def formats() -> list[dict[str, Any]]:
    """What each format is called, its endings, whether it is written, and what it keeps.

    The latter by the names of :class:`~pliant.io.mesh_formats.format.Keeps`.
    """
    return [
        {"name": each.name, "suffixes": each.suffixes, "written": each.written, **asdict(each.keeps)} for each in _all()
    ]


@cache
def _format(place: str) -> MeshFormat:
    module, _, name = place.partition(":")
    found: MeshFormat = getattr(import_module(module), name)()
    return found


def _all() -> Iterator[MeshFormat]:
    return (_format(place) for place in _FORMATS)


def _stream_name(stream: BinaryIO) -> str:
    name = getattr(stream, "name", None)
    return name if isinstance(name, str) else "stream"


def _plain(name: Path | str) -> Path | str:
    """A name without the ending of compressed files."""
    return type(name)(str(name)[:-3]) if str(name).lower().endswith(".gz") else name


def _inflated(data: bytes, name: Path | str) -> bytes:
    """What a file holds, compressed or not.

    Raises
    ------
    UnreadableFile
        Damaged compression, or more than any honest mesh inflates to.
    """
    if not is_gzipped(data):
        return data
    most = _ROOM + _GROWTH * len(data)
    whole = inflated(Path(name), data, most + 1)
    if len(whole) > most:
        cause = f"{len(data):,} compressed bytes inflate to more than {most:,}"
        raise UnreadableFile(name, cause, "if that is meant, decompress the file yourself and read what comes out")
    return whole


def _by_suffix(path: Path | str) -> list[MeshFormat]:
    """The formats that know an ending, the usual one first."""
    ending = Path(path).suffix.lower()
    return [_format(place) for place, endings in _FORMATS.items() if ending in endings]


def _writer(path: Path, mesh: PolygonMesh) -> MeshFormat:
    """The format of an ending: the mesh's own if that is among those that have it."""
    found = _by_suffix(path)
    if not found:
        endings = ", ".join(dict.fromkeys(ending for each in _all() if each.written for ending in each.suffixes))
        raise UnsupportedFormat(f"{path}: no mesh format has the ending {path.suffix!r}; there are {endings}")
    own = mesh.carrier.format if isinstance(mesh.carrier, Carrier) else None
    return next((each for each in found if each.name == own), found[0])


def _recognised(source: Source) -> MeshFormat:
    candidates = [each for each in _all() if each.sniff(source.data)] or _by_suffix(source.name)
    found = candidates[0] if candidates else None
    if found is None:
        names = ", ".join(each.name for each in _all())
        raise UnsupportedFormat(f"{source.name}: neither its bytes nor its ending say what it is; pliant reads {names}")
    return found
