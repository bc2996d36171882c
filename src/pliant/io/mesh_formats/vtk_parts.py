"""What VTK's formats share: what a file holds, and how its arrays become a mesh's attributes."""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import MissingExtra
from pliant.io.mesh_formats.format import Source
from pliant.mesh import CornerValues
from pliant.numerics.ragged import Ragged

Arrays = Mapping[str, NDArray[Any]]

KINDS = {  # what is no polydata, as files name it without underscores, and as VTK's classes do
    "unstructuredgrid": "UnstructuredGrid",
    "imagedata": "ImageData",
    "structuredpoints": "ImageData",
    "rectilineargrid": "RectilinearGrid",
    "structuredgrid": "StructuredGrid",
}
_XML = re.compile(
    rb"\s*(?:<\?xml[^>]*>)?(?>\s++|<!--(?:(?!-->).)*-->)*+<VTKFile\b[^>]*\btype\s*=\s*[\"'](\w+)[\"']", re.S
)
_LEGACY = re.compile(rb"# vtk DataFile Version[^\n]*\n[^\n]*\n\s*(ASCII|BINARY)\s*\n\s*DATASET\s+(\w+)", re.I)


def vtk_kind(data: bytes) -> str | None:
    """What a VTK file says that it holds, in lower case without underscores; None where it is no VTK file."""
    legacy, xml = _LEGACY.match(data[:4096]), _XML.match(data[:4096])
    if legacy is None and xml is None:
        return "unknown data" if data.startswith(b"# vtk DataFile") else None
    word = legacy[2] if legacy else xml[1] if xml else b""
    return word.decode().lower().replace("_", "")


def require_vtk(purpose: str) -> None:
    """Insist that VTK is installed.

    Raises
    ------
    MissingExtra
        It is not.
    """
    if importlib.util.find_spec("vtkmodules") is None:
        raise MissingExtra(purpose, "render")


def style(data: bytes) -> Mapping[str, bool]:
    """How a file stores its numbers, so that it can be written in the same way."""
    head = data[:65536]
    legacy = _LEGACY.match(head)
    return {
        "legacy": legacy is not None,
        "text": legacy[1].upper() == b"ASCII" if legacy else b'format="ascii"' in head,
        "raw": b'encoding="raw"' in data,
        "compressed": b"compressor=" in head,
    }


def ragged_cells(source: Source, arrays: Arrays, name: str, count: int) -> Ragged:
    """Rows of point indices.

    Raises
    ------
    UnreadableFile
        Offsets that contradict the indices, or an index beyond the points.
    """
    flat, offsets = arrays[f"{name}.flat"], arrays[f"{name}.offsets"]
    ordered = len(offsets) and offsets[0] == 0 and offsets[-1] == len(flat) and (np.diff(offsets) >= 0).all()
    if not ordered:
        raise source.unreadable(f"the offsets of {name} contradict their connectivity", "export the file again")
    if flat.size and not 0 <= flat.min() <= flat.max() < count:
        worst = flat.min() if flat.min() < 0 else flat.max()
        raise source.unreadable(f"{name} use point {worst}; the file has {count:,}", "export the file again")
    return Ragged(flat.astype(np.int32), offsets)


def point_data(
    arrays: Arrays, meta: Mapping[str, Any], polygons: Ragged
) -> tuple[dict[str, NDArray[Any]], CornerValues | None]:
    """Vertex attributes by name, and texture coordinates."""
    vertices = {name: arrays[f"point.{i}"] for i, name in enumerate(meta["names"]["point"])}
    active = meta["active"]["point"]
    normals = vertices.pop(active.get("Normals"), None)
    coordinates = vertices.pop(active.get("TCoords"), None)
    named = {_mesh_name(name, each, active.get("Scalars")): each for name, each in vertices.items()}
    if normals is not None:
        named["normals"] = normals.astype(np.float64)
    if coordinates is None or coordinates.ndim != 2:
        return named, None
    return named, CornerValues(coordinates, polygons.flat)


def cell_data(
    source: Source, arrays: Arrays, meta: Mapping[str, Any], row: NDArray[np.int64], count: int
) -> dict[str, NDArray[Any]]:
    """Face attributes by name; ``row`` says which cell each face is, of ``count``.

    Raises
    ------
    UnreadableFile
        Data of another length.
    """
    scalars = meta["active"]["cell"].get("Scalars")
    faces = {}
    for i, name in enumerate(meta["names"]["cell"]):
        values = arrays[f"cell.{i}"]
        if len(values) != count:
            raise source.unreadable(f"the cell data {name!r} has {len(values):,} rows", "export the file again")
        faces[_mesh_name(name, values, scalars)] = values[row]
    return faces


def texts(meta: Mapping[str, Any]) -> tuple[str, ...]:
    """The arrays that are no numbers, as sentences."""
    return tuple(f"the text array {name!r}" for name in meta["skipped"])


def _mesh_name(name: str, values: NDArray[Any], scalars: str | None) -> str:
    """Bytes of three or four components that a file has as its scalars are colours."""
    colored = name == scalars and values.dtype == np.uint8 and values.ndim == 2 and values.shape[1] in (3, 4)
    return "colors" if colored else name
