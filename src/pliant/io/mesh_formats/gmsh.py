"""gmsh's .msh: read by meshio in a process of its own; triangles, quadrilaterals, and the cells of volumes."""

from __future__ import annotations

import importlib.util
import tempfile
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import MissingExtra, UnwritableFile
from pliant.io.mesh_formats import polydata_process
from pliant.io.mesh_formats.carrier import carrier_of, with_carrier
from pliant.io.mesh_formats.format import Encoded, Keeps, MeshFormat, Source
from pliant.io.mesh_formats.gmsh_nodes import FORMAT, Nodes, located
from pliant.io.mesh_formats.losses import losses_of
from pliant.mesh import FaceLabels, PolygonMesh
from pliant.numerics.ragged import Ragged

_SIDES = {"triangle": 3, "quad": 4}
_CELLS = {
    "tetra",
    "hexahedron",
    "wedge",
    "pyramid",
    "line3",
    "triangle6",
    "quad8",
    "quad9",
    "tetra10",
    "hexahedron20",
    "hexahedron27",
    "wedge15",
    "wedge18",
    "pyramid13",
    "pyramid14",
}
_PHYSICAL = "gmsh:physical"


class Gmsh(MeshFormat):
    """gmsh files of any version that meshio reads; 2.2 and 4.1 are written back with other positions alone."""

    name = "gmsh"
    suffixes = (".msh",)
    keeps = Keeps(polygons=True, cells=True, lines=True)

    def sniff(self, data: bytes) -> bool:
        """Whether the file begins with the section of a gmsh format."""
        return FORMAT.match(data[:256]) is not None

    def read(self, source: Source) -> PolygonMesh:
        """The mesh that a gmsh file holds."""
        if not self.sniff(source.data):
            raise source.unreadable("the file does not begin with $MeshFormat", "check what it is", at=0)
        _require_meshio("reading gmsh files")
        arrays, meta = polydata_process.read(source, "gmsh", child="pliant.io.mesh_formats.gmsh_child", reader="meshio")
        kinds = list(enumerate(meta["kinds"]))
        faces = [i for i, kind in kinds if kind in _SIDES]
        lines = [arrays[f"cells.{i}"] for i, kind in kinds if kind == "line"]
        cells: dict[str, NDArray[Any]] = {}
        for i, kind in kinds:
            if kind not in (*_SIDES, "line", "vertex"):
                block = arrays[f"cells.{i}"]
                cells[kind] = np.concatenate([cells[kind], block]) if kind in cells else block
        attributes = {
            name: np.concatenate([arrays[f"cell.{k}.{i}"] for i in faces])
            for k, name in enumerate(meta["cell"])
            if faces
        }
        mesh = PolygonMesh(
            arrays["points"],
            _ragged([arrays[f"cells.{i}"] for i in faces]),
            groups=_groups(attributes.get(_PHYSICAL), meta["physical"]),
            lines=_ragged(lines) if lines else None,
            cells=cells,
            vertex_attributes={name: arrays[f"point.{i}"] for i, name in enumerate(meta["point"])},
            face_attributes=attributes,
        )
        unique = ["the entities and tags of gmsh's cells"]
        return with_carrier(mesh, self.name, source.data, located(source, mesh.points), tuple(unique))

    def encode(self, mesh: PolygonMesh, path: Path) -> Encoded:
        """The file that the mesh was read from, with other positions; a new one if that was none or another."""
        carrier = carrier_of(mesh, self.name)
        if carrier is not None and np.array_equal(carrier.mesh.points, mesh.points):
            return Encoded([carrier.data])
        if carrier is not None and isinstance(carrier.layout, Nodes):
            return Encoded([carrier.layout.exchanged(carrier.data, carrier.mesh.points, mesh.points)])
        _require_meshio("writing gmsh files")
        return _new_file(mesh, self.keeps)


def _require_meshio(purpose: str) -> None:
    if importlib.util.find_spec("meshio") is None:
        raise MissingExtra(purpose, "formats")


def _ragged(blocks: list[NDArray[Any]]) -> Ragged:
    """The rows of tables of different widths, one after another."""
    lengths = np.concatenate([np.empty(0, np.int64), *(np.full(len(block), block.shape[1]) for block in blocks)])
    flat = np.concatenate([np.empty(0, np.int64), *(block.ravel() for block in blocks)])
    return Ragged(flat.astype(np.int32), np.concatenate([[0], np.cumsum(lengths)]))


def _groups(physical: NDArray[Any] | None, names: Mapping[str, list[int]]) -> FaceLabels | None:
    """The physical surfaces that have names."""
    surfaces = {name: pair[0] for name, pair in names.items() if len(pair) == 2 and pair[1] == 2}
    if physical is None or not surfaces:
        return None
    numbers = np.array(list(surfaces.values()))
    found = physical[:, None] == numbers
    return FaceLabels(tuple(surfaces), np.where(found.any(axis=1), found.argmax(axis=1), -1).astype(np.int32))


def _new_file(mesh: PolygonMesh, keeps: Keeps) -> Encoded:
    """A file of version 2.2, binary."""
    import meshio

    losses = list(losses_of(mesh, keeps, known_faces=(_PHYSICAL,)))
    sides = mesh.faces.lengths
    order = mesh.face_attributes.get(_PHYSICAL, np.zeros(len(sides), np.int64))
    blocks: list[tuple[str, NDArray[Any]]] = []
    tags: list[NDArray[Any]] = []
    if ((sides < 3) | (sides > 4)).any():
        losses.append("faces of more than four corners are not gmsh's: all are cut into triangles")
        blocks, tags = [("triangle", mesh.triangles)], [order[mesh.triangle_faces]]
    else:
        for begin, stop in _runs(sides):
            rows = mesh.faces.flat[mesh.faces.offsets[begin] : mesh.faces.offsets[stop]].reshape(stop - begin, -1)
            blocks.append(("triangle" if sides[begin] == 3 else "quad", rows))
            tags.append(order[begin:stop])
    if mesh.lines is not None:
        ends = np.array([pair for row in mesh.lines for pair in pairwise(row)]).reshape(-1, 2)
        blocks.append(("line", ends))
        if (longer := int((mesh.lines.lengths != 2).sum())) > 0:
            losses.append(f"{longer:,} lines of more than two points are cut into segments")
    for kind, rows in mesh.cells.items():
        if kind in _CELLS:
            blocks.append((kind, rows))
        else:
            losses.append(f"{len(rows):,} cells of the kind {kind!r}")
    tags += [np.zeros(len(rows), np.int64) for _, rows in blocks[len(tags) :]]
    data = {name: [each.astype(np.int32) for each in tags] for name in (_PHYSICAL, "gmsh:geometrical")}
    with tempfile.TemporaryDirectory(prefix="pliant-") as folder:
        path = Path(folder, "mesh.msh")
        try:
            meshio.write(path, meshio.Mesh(mesh.points, blocks, cell_data=data), file_format="gmsh22", binary=True)
        except OSError as error:  # the folder of temporary files is full
            raise UnwritableFile(path, error.strerror or str(error)) from error
        return Encoded([path.read_bytes()], tuple(losses))


def _runs(values: NDArray[np.int64]) -> list[tuple[int, int]]:
    """Where stretches of equal values begin and end."""
    bounds = np.concatenate([[0], np.flatnonzero(np.diff(values)) + 1, [len(values)]])
    return [(int(a), int(b)) for a, b in pairwise(bounds) if b > a]
