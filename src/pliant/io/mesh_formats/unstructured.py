"""VTK unstructured grids, .vtu and the older .vtk: polygons, lines and the cells of volumes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnsupportedFormat
from pliant.io.mesh_formats import polydata_process, polydata_writer
from pliant.io.mesh_formats.carrier import carrier_of, with_carrier
from pliant.io.mesh_formats.format import Encoded, Keeps, MeshFormat, Source
from pliant.io.mesh_formats.polydata_writer import Layout
from pliant.io.mesh_formats.vtk_cells import CELL_TYPES, FACES, LINES, PIXEL, POLYHEDRON
from pliant.io.mesh_formats.vtk_parts import cell_data, point_data, ragged_cells, require_vtk, style, texts, vtk_kind
from pliant.mesh import PolygonMesh
from pliant.numerics.ragged import Ragged


class Unstructured(MeshFormat):
    """VTK unstructured grids: two-dimensional cells are the faces, volumes ride along."""

    name = "VTK unstructured"
    suffixes = (".vtu", ".vtk")
    keeps = Keeps(
        polygons=True,
        cells=True,
        lines=True,
        vertex_normals=True,
        vertex_colors=True,
        face_colors=True,
        vertex_attributes=True,
        face_attributes=True,
    )

    def sniff(self, data: bytes) -> bool:
        """Whether the file says that it holds an unstructured grid."""
        return vtk_kind(data) == "unstructuredgrid"

    def read(self, source: Source) -> PolygonMesh:
        """The mesh that an unstructured grid holds."""
        if not self.sniff(source.data):
            raise source.unreadable("the header is not that of an unstructured grid", "check what it is", at=0)
        require_vtk("reading VTK files")
        arrays, meta = polydata_process.read(source, "UnstructuredGrid")
        points, types = arrays["points"].astype(np.float64), arrays["cells.types"]
        rows = ragged_cells(source, arrays, "cells", len(points))
        if (types == POLYHEDRON).any():
            raise UnsupportedFormat(f"{source.name}: cells that are polyhedra; split them into tetrahedra first")
        at = np.flatnonzero(np.isin(types, FACES))
        polygons = _picked(_unfolded(rows, types), at)
        lines = _picked(rows, np.flatnonzero(np.isin(types, LINES)))
        vertices, uvs = point_data(arrays, meta, polygons)
        mesh = PolygonMesh(
            points,
            polygons,
            uvs=uvs,
            vertex_attributes=vertices,
            face_attributes=cell_data(source, arrays, meta, at, len(types)),
            lines=lines if len(lines) else None,
            cells=_volumes(source, rows, types),
        )
        other = int((~np.isin(types, [*FACES, *LINES, *CELL_TYPES])).sum())
        unique = [f"{other:,} cells that are points or strips"] * bool(other) + [*texts(meta)]
        if meta["names"]["cell"] and len(at) < len(types):
            unique.append("the data of cells that are no faces")
        if meta["names"]["field"]:
            unique.append(f"{len(meta['names']['field'])} arrays of field data")
        return with_carrier(mesh, self.name, source.data, Layout(arrays, meta, style(source.data)), tuple(unique))

    def encode(self, mesh: PolygonMesh, path: Path) -> Encoded:
        """The file that the mesh was read from, with other positions; a new one if that was none or another."""
        require_vtk("writing VTK files")
        carrier = carrier_of(mesh, self.name)
        if carrier:
            return polydata_writer.same_file(mesh, carrier, path)
        return polydata_writer.new_file(mesh, self.keeps, path, volumes=True)


def _picked(rows: Ragged, at: NDArray[np.int64]) -> Ragged:
    """Some of the rows."""
    lengths = rows.lengths[at]
    offsets = np.concatenate([[0], np.cumsum(lengths)])
    flat = rows.flat[np.repeat(rows.offsets[at] - offsets[:-1], lengths) + np.arange(offsets[-1])]
    return Ragged(flat, offsets)


def _unfolded(rows: Ragged, types: NDArray[np.uint8]) -> Ragged:
    """The rows with pixels, whose last two corners VTK stores the other way round, as quadrilaterals."""
    at = rows.offsets[:-1][(types == PIXEL) & (rows.lengths == 4)]
    if not len(at):
        return rows
    flat = rows.flat.copy()
    flat[at + 2], flat[at + 3] = rows.flat[at + 3], rows.flat[at + 2]
    return Ragged(flat, rows.offsets)


def _volumes(source: Source, rows: Ragged, types: NDArray[np.uint8]) -> dict[str, NDArray[np.int32]]:
    """The cells of volumes, and curved ones, by the names of their kinds."""
    result = {}
    for kind in np.unique(types).tolist():
        if kind not in CELL_TYPES:
            continue
        name, corners = CELL_TYPES[kind]
        at = np.flatnonzero(types == kind)
        if (rows.lengths[at] != corners).any():
            raise source.unreadable(f"a cell of the kind {name!r} has not {corners} points", "export the file again")
        result[name] = _picked(rows, at).flat.reshape(-1, corners)
    return result
