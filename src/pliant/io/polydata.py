"""VTK polydata, .vtp and the older .vtk: read by VTK in a process of its own, written by VTK here."""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import MissingExtra, UnsupportedFormat
from pliant.io import polydata_process, polydata_writer
from pliant.io.carrier import carrier_of, with_carrier
from pliant.io.format import Encoded, Keeps, MeshFormat, Source
from pliant.io.polydata_writer import Layout
from pliant.mesh import CornerValues, PolygonMesh
from pliant.numerics.ragged import Ragged

_XML = re.compile(
    rb"\s*(?:<\?xml[^>]*>)?(?>\s++|<!--(?:(?!-->).)*-->)*+<VTKFile\b[^>]*\btype\s*=\s*[\"'](\w+)[\"']", re.S
)
_LEGACY = re.compile(rb"# vtk DataFile Version[^\n]*\n[^\n]*\n\s*(ASCII|BINARY)\s*\n\s*DATASET\s+(\w+)", re.I)


class PolyData(MeshFormat):
    """VTK polydata; cells, point data and cell data of any name and type."""

    name = "VTK"
    suffixes = (".vtp", ".vtk")
    keeps = Keeps(
        polygons=True,
        lines=True,
        vertex_normals=True,
        vertex_colors=True,
        face_colors=True,
        vertex_attributes=True,
        face_attributes=True,
    )

    def sniff(self, data: bytes) -> bool:
        """Whether the file begins as VTK's do."""
        return data.startswith(b"# vtk DataFile") or _XML.match(data[:4096]) is not None

    def read(self, source: Source) -> PolygonMesh:
        """The mesh that a VTK file holds."""
        _require_polydata(source)
        _require_vtk("reading VTK files")
        arrays, meta = polydata_process.read(source)
        points = arrays["points"].astype(np.float64)
        cells = {name: _cells(source, arrays, name, len(points)) for name in polydata_process.CELLS}
        polygons, row = _polygons(cells)
        vertices = {name: arrays[f"point.{i}"] for i, name in enumerate(meta["names"]["point"])}
        active = meta["active"]["point"]
        normals = vertices.pop(active.get("Normals"), None)
        coordinates = vertices.pop(active.get("TCoords"), None)
        named = {_mesh_name(name, each, active.get("Scalars")): each for name, each in vertices.items()}
        if normals is not None:
            named["normals"] = normals.astype(np.float64)
        uvs = None
        if coordinates is not None and coordinates.ndim == 2:
            uvs = CornerValues(coordinates, polygons.flat)
        scalars = meta["active"]["cell"].get("Scalars")
        faces = {}
        for i, name in enumerate(meta["names"]["cell"]):
            values = arrays[f"cell.{i}"]
            if len(values) != sum(map(len, cells.values())):
                raise source.unreadable(f"the cell data {name!r} has {len(values):,} rows", "export the file again")
            faces[_mesh_name(name, values, scalars)] = values[row]
        lines = cells["lines"]
        mesh = PolygonMesh(
            points,
            polygons,
            uvs=uvs,
            vertex_attributes=named,
            face_attributes=faces,
            lines=lines if len(lines) else None,
        )
        return with_carrier(
            mesh, self.name, source.data, Layout(arrays, meta, _style(source.data)), _unique(cells, meta)
        )

    def encode(self, mesh: PolygonMesh, path: Path) -> Encoded:
        """The file that the mesh was read from, with other positions; a new one if that was none or another."""
        _require_vtk("writing VTK files")
        carrier = carrier_of(mesh, self.name)
        return (
            polydata_writer.same_file(mesh, carrier, path)
            if carrier
            else polydata_writer.new_file(mesh, self.keeps, path)
        )


def _require_vtk(purpose: str) -> None:
    if importlib.util.find_spec("vtkmodules") is None:
        raise MissingExtra(purpose, "render")


def _require_polydata(source: Source) -> None:
    legacy = _LEGACY.match(source.data[:4096])
    xml = _XML.match(source.data[:4096])
    if legacy is None and xml is None:
        raise source.unreadable("the header is not that of a VTK file", "export the file again", at=0)
    kind = (legacy[2] if legacy else xml[1] if xml else b"").decode()
    if kind.lower() != "polydata":
        raise UnsupportedFormat(f"{source.name}: a VTK file of {kind}; extract its surface as polydata first")


def _style(data: bytes) -> Mapping[str, bool]:
    """How a file stores its numbers, so that it can be written in the same way."""
    head = data[:65536]
    legacy = _LEGACY.match(head)
    return {
        "legacy": legacy is not None,
        "text": legacy[1].upper() == b"ASCII" if legacy else b'format="ascii"' in head,
        "raw": b'encoding="raw"' in data,
        "compressed": b"compressor=" in head,
    }


def _cells(source: Source, arrays: Mapping[str, NDArray[Any]], name: str, count: int) -> Ragged:
    flat, offsets = arrays[f"{name}.flat"], arrays[f"{name}.offsets"]
    ordered = len(offsets) and offsets[0] == 0 and offsets[-1] == len(flat) and (np.diff(offsets) >= 0).all()
    if not ordered:
        raise source.unreadable(f"the offsets of {name} contradict their connectivity", "export the file again")
    if flat.size and not 0 <= flat.min() <= flat.max() < count:
        worst = flat.min() if flat.min() < 0 else flat.max()
        raise source.unreadable(f"{name} use point {worst}; the file has {count:,}", "export the file again")
    return Ragged(flat.astype(np.int32), offsets)


def _polygons(cells: Mapping[str, Ragged]) -> tuple[Ragged, NDArray[np.int64]]:
    """Polygons and the triangles of strips, and which row of the cell data belongs to each."""
    polys, strips = cells["polys"], cells["strips"]
    before = len(cells["verts"]) + len(cells["lines"])
    row = before + np.arange(len(polys))
    if not len(strips):
        return polys, row
    pieces = np.maximum(strips.lengths - 2, 0)
    strip = np.repeat(np.arange(len(strips)), pieces)
    step = np.arange(len(strip)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    corner = strips.offsets[strip] + step
    odd = step % 2
    trio = strips.flat[np.stack([corner + odd, corner + 1 - odd, corner + 2], axis=1)]
    flat = np.concatenate([polys.flat, trio.reshape(-1)])
    offsets = np.concatenate([polys.offsets, polys.offsets[-1] + 3 * np.arange(1, len(trio) + 1)])
    return Ragged(flat, offsets), np.concatenate([row, before + len(polys) + strip])


def _mesh_name(name: str, values: NDArray[Any], scalars: str | None) -> str:
    """Bytes of three or four components that a file has as its scalars are colours."""
    colored = name == scalars and values.dtype == np.uint8 and values.ndim == 2 and values.shape[1] in (3, 4)
    return "colors" if colored else name


def _unique(cells: Mapping[str, Ragged], meta: Mapping[str, Any]) -> tuple[str, ...]:
    found = []
    if len(cells["verts"]):
        found.append(f"{len(cells['verts']):,} cells that are points")
    if meta["names"]["cell"] and len(cells["verts"]) + len(cells["lines"]):
        found.append("the cell data of points and lines")
    if meta["names"]["field"]:
        found.append(f"{len(meta['names']['field'])} arrays of field data")
    found += [f"the text array {name!r}" for name in meta["skipped"]]
    return tuple(found)
