"""VTK polydata, .vtp and the older .vtk.

Plain .vtp files are read here, all others by VTK in a process of its own; VTK writes them.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnsupportedFormat
from pliant.io.mesh_formats import polydata_process, polydata_writer, vtp_file
from pliant.io.mesh_formats.carrier import carrier_of, with_carrier
from pliant.io.mesh_formats.format import Encoded, Keeps, MeshFormat, Source
from pliant.io.mesh_formats.polydata_writer import Layout
from pliant.io.mesh_formats.vtk_parts import (
    KINDS,
    cell_data,
    point_data,
    ragged_cells,
    require_vtk,
    style,
    texts,
    vtk_kind,
)
from pliant.mesh import PolygonMesh
from pliant.numerics.ragged import Ragged


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
        """Whether the file begins as VTK's do; other formats claim what is no polydata."""
        return vtk_kind(data) not in (None, *KINDS)

    def read(self, source: Source) -> PolygonMesh:
        """The mesh that a VTK file holds."""
        kind = vtk_kind(source.data)
        if kind is None:
            raise source.unreadable("the header is not that of a VTK file", "export the file again", at=0)
        if kind != "polydata":
            raise UnsupportedFormat(f"{source.name}: a VTK file of {kind}; extract its surface as polydata first")
        arrays, meta = vtp_file.read(source.data) or self._by_vtk(source)
        points = arrays["points"].astype(np.float64)
        cells = {name: ragged_cells(source, arrays, name, len(points)) for name in polydata_process.CELLS}
        polygons, row = _polygons(cells)
        lines = cells["lines"]
        vertices, uvs = point_data(arrays, meta, polygons)
        mesh = PolygonMesh(
            points,
            polygons,
            uvs=uvs,
            vertex_attributes=vertices,
            face_attributes=cell_data(source, arrays, meta, row, sum(map(len, cells.values()))),
            lines=lines if len(lines) else None,
        )
        layout = Layout(arrays, meta, style(source.data))
        return with_carrier(mesh, self.name, source.data, layout, _unique(cells, meta))

    def _by_vtk(self, source: Source) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
        require_vtk("reading VTK files")
        return polydata_process.read(source)

    def encode(self, mesh: PolygonMesh, path: Path) -> Encoded:
        """The file that the mesh was read from, with other positions; a new one if that was none or another."""
        require_vtk("writing VTK files")
        carrier = carrier_of(mesh, self.name)
        return (
            polydata_writer.same_file(mesh, carrier, path)
            if carrier
            else polydata_writer.new_file(mesh, self.keeps, path)
        )


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


def _unique(cells: Mapping[str, Ragged], meta: Mapping[str, Any]) -> tuple[str, ...]:
    found = []
    if len(cells["verts"]):
        found.append(f"{len(cells['verts']):,} cells that are points")
    if meta["names"]["cell"] and len(cells["verts"]) + len(cells["lines"]):
        found.append("the cell data of points and lines")
    if meta["names"]["field"]:
        found.append(f"{len(meta['names']['field'])} arrays of field data")
    return (*found, *texts(meta))
