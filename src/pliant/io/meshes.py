"""Reading and writing meshes: which format a file has, and what all formats share.

A format is one module and one line of the table below; it is imported when it is first needed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from pliant.errors import InvalidMesh, UnsupportedFormat
from pliant.io.files import read_bytes, write_bytes
from pliant.io.format import MeshFormat, Source
from pliant.io.report import LossReport, refuse_losses
from pliant.mesh import PolygonMesh

_FORMATS = {  # module and class by ending; files are recognised in this order
    "pliant.io.ply:Ply": (".ply",),
    "pliant.io.polydata:PolyData": (".vtp", ".vtk"),
    "pliant.io.off:Off": (".off", ".coff", ".noff", ".stoff"),
    "pliant.io.stl:Stl": (".stl",),
    "pliant.io.obj:Obj": (".obj",),
}


def read(path: Path | str) -> PolygonMesh:
    """Read a mesh; its format is recognised by what the file holds, and by its ending only where that says nothing.

    Raises
    ------
    UnreadableFile
        The file is not there, is cut off or contradicts itself; the line or byte, the cause and the cure are named.
    UnsupportedFormat
        The file is of no format that pliant reads.
    """
    path = Path(path)
    return read_mesh_bytes(read_bytes(path), path, folder=path.parent)


def read_mesh_bytes(data: bytes, name: Path | str, *, folder: Path | None = None) -> PolygonMesh:
    """A mesh from the bytes of a file.

    Parameters
    ----------
    data
        The whole file.
    name
        What errors call it; its ending counts where the bytes do not say what they are.
    folder
        Where files that it refers to are looked for; None: nowhere.

    Raises
    ------
    UnreadableFile, UnsupportedFormat
        As :func:`read`.
    """
    source = Source(data, name, folder)
    try:
        mesh = _recognised(source).read(source)
    except InvalidMesh as error:
        raise source.unreadable(str(error), "repair the file, or export it again") from error
    return mesh.replace(source=Path(name))


def write(mesh: PolygonMesh, path: Path | str, *, strict: bool = False) -> LossReport:
    """Write a mesh in the format that the path's ending names.

    A mesh written in the format that it was read from differs in its positions, and in stored normals, only.

    Parameters
    ----------
    mesh
        The mesh.
    path
        Where to; an existing file is replaced once the new one is complete.
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
    path = Path(path)
    target = _by_suffix(path)
    if target is None:
        endings = ", ".join(ending for endings in _FORMATS.values() for ending in endings)
        raise UnsupportedFormat(f"{path}: no mesh format has the ending {path.suffix!r}; there are {endings}")
    empty = np.flatnonzero(mesh.faces.lengths == 0)
    if len(empty):
        raise UnsupportedFormat(f"face {empty[0]} has no corners, and no file can say so: remove it")
    encoded = target.encode(mesh, path)
    refuse_losses(encoded.losses, path, strict=strict)
    for companion, data in encoded.companions.items():
        write_bytes(companion, data)
    write_bytes(path, encoded.parts)
    return LossReport(path, target.name, encoded.losses, encoded.notes)


def formats() -> list[dict[str, Any]]:
    """What each format is called, its endings, and what it keeps, by the names of :class:`~pliant.io.format.Keeps`."""
    return [{"name": each.name, "suffixes": each.suffixes, **asdict(each.keeps)} for each in _all()]


@cache
def _format(place: str) -> MeshFormat:
    module, _, name = place.partition(":")
    found: MeshFormat = getattr(import_module(module), name)()
    return found


def _all() -> Iterator[MeshFormat]:
    return (_format(place) for place in _FORMATS)


def _by_suffix(path: Path | str) -> MeshFormat | None:
    ending = Path(path).suffix.lower()
    return next((_format(place) for place, endings in _FORMATS.items() if ending in endings), None)


def _recognised(source: Source) -> MeshFormat:
    found = next((each for each in _all() if each.sniff(source.data)), None) or _by_suffix(source.name)
    if found is None:
        names = ", ".join(each.name for each in _all())
        raise UnsupportedFormat(f"{source.name}: neither its bytes nor its ending say what it is; pliant reads {names}")
    return found
