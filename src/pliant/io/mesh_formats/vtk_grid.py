"""VTK's grids, .vti, .vtr and .vts: read as the points that they imply, with their data; never written.

A deformed grid is no grid of these kinds any more; its points are written to any other format.
"""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from pliant.errors import UnsupportedFormat
from pliant.io.mesh_formats import polydata_process
from pliant.io.mesh_formats.format import Encoded, Keeps, MeshFormat, Source
from pliant.io.mesh_formats.vtk_parts import KINDS, point_data, require_vtk, vtk_kind
from pliant.mesh import PolygonMesh
from pliant.numerics.ragged import Ragged


class VtkGrid(MeshFormat):
    """Image data, rectilinear and structured grids as clouds of points."""

    name = "VTK grid"
    suffixes = (".vti", ".vtr", ".vts")
    keeps = Keeps(faces=False, vertex_normals=True, vertex_colors=True, vertex_attributes=True)
    written: ClassVar[bool] = False

    def sniff(self, data: bytes) -> bool:
        """Whether the file says that it holds a grid."""
        kind = vtk_kind(data)
        return kind in KINDS and kind != "unstructuredgrid"

    def read(self, source: Source) -> PolygonMesh:
        """The points that a grid implies, x fastest, with the data that they have."""
        kind = vtk_kind(source.data)
        if kind is None or not self.sniff(source.data):
            raise source.unreadable("the header is not that of a VTK grid", "check what it is", at=0)
        require_vtk("reading VTK files")
        arrays, meta = polydata_process.read(source, KINDS[kind])
        vertices, _ = point_data(arrays, meta, Ragged.of([]))
        return PolygonMesh(arrays["points"], vertex_attributes=vertices)

    def encode(self, mesh: PolygonMesh, path: Path) -> Encoded:
        """Refused: what deforms is no grid."""
        raise UnsupportedFormat(f"{path}: a grid cannot hold points that moved; write .vtu, .vtp or .csv")
