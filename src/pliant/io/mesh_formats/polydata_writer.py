"""Writing VTK polydata and unstructured grids from arrays, by VTK."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnwritableFile
from pliant.io.mesh_formats.carrier import Carrier
from pliant.io.mesh_formats.format import Encoded, Keeps
from pliant.io.mesh_formats.losses import as_float32, losses_of, per_vertex
from pliant.io.mesh_formats.polydata_child import CELLS
from pliant.io.mesh_formats.vtk_cells import cells_of
from pliant.mesh import PolygonMesh

Arrays = dict[str, NDArray[Any]]
_NEW = {"text": False, "raw": False, "compressed": True}


@dataclass(frozen=True, eq=False)
class Layout:
    """What a VTK file holds: its arrays, their names, and how it stores them."""

    arrays: Arrays
    meta: Mapping[str, Any]
    style: Mapping[str, bool]


def same_file(mesh: PolygonMesh, carrier: Carrier, path: Path) -> Encoded:
    """The file that the mesh was read from with its positions and normals exchanged, in the types that they had."""
    layout: Layout = carrier.layout
    arrays = dict(layout.arrays)
    notes: tuple[str, ...] = ()
    normals = mesh.vertex_attributes.get("normals")
    moved = not np.array_equal(mesh.points, carrier.mesh.points)
    turned = normals is not None and not np.array_equal(normals, carrier.mesh.vertex_attributes["normals"])
    legacy = path.suffix.lower() == ".vtk"
    if not (moved or turned) and legacy == layout.style["legacy"]:
        return Encoded([carrier.data])
    kind = arrays["points"].dtype
    if kind == np.float32:
        arrays["points"], notes = as_float32(mesh.points, "VTK")
    else:
        arrays["points"] = mesh.points
    if turned:
        at = layout.meta["names"]["point"].index(layout.meta["active"]["point"]["Normals"])
        arrays[f"point.{at}"] = np.asarray(normals).astype(arrays[f"point.{at}"].dtype)
    skipped = tuple(f"the text array {name!r}" for name in layout.meta["skipped"])
    style = layout.style if legacy == layout.style["legacy"] else _NEW
    return Encoded([_bytes(arrays, layout.meta, style, legacy=legacy)], skipped, notes)


def new_file(mesh: PolygonMesh, keeps: Keeps, path: Path, *, volumes: bool = False) -> Encoded:
    """A file written from the mesh alone; with ``volumes`` an unstructured grid."""
    losses = losses_of(mesh, keeps)
    arrays: Arrays = {"points": mesh.points}
    if volumes:
        cells, unknown = cells_of(mesh)
        arrays |= cells
        losses += unknown
    else:
        none = np.zeros(1, np.int64)
        for name, rows in zip(CELLS, (None, mesh.lines, mesh.faces, None), strict=True):
            arrays[f"{name}.offsets"] = none if rows is None else rows.offsets
            arrays[f"{name}.flat"] = none[:0] if rows is None else rows.flat.astype(np.int64)
    point = dict(mesh.vertex_attributes)
    if mesh.normals is not None and "normals" not in point and per_vertex(mesh, mesh.normals):
        point["normals"] = mesh.normals.values
    active: dict[str, dict[str, str]] = {"point": {}, "cell": {}}
    if mesh.uvs is not None and per_vertex(mesh, mesh.uvs):
        losses = tuple(loss for loss in losses if not loss.endswith("texture coordinates"))
        name = "texture coordinates"
        point[name], active["point"]["TCoords"] = mesh.uvs.values, name
    if "normals" in point:
        active["point"]["Normals"] = "normals"
    cell = dict(mesh.face_attributes)
    before = 0 if mesh.lines is None else len(mesh.lines)
    after = len(arrays["cells.types"]) - before - len(mesh.faces) if volumes else 0
    cell = {name: _padded(values, before, after) for name, values in cell.items()}
    for kind, fields in (("point", point), ("cell", cell)):
        if "colors" in fields:
            active[kind]["Scalars"] = "colors"
        arrays |= {f"{kind}.{i}": _storable(values) for i, values in enumerate(fields.values())}
    meta = {"names": {"point": list(point), "cell": list(cell), "field": []}, "active": active}
    legacy = path.suffix.lower() == ".vtk"
    return Encoded([_bytes(arrays, meta, _NEW, legacy=legacy)], losses)


def _padded(values: NDArray[Any], before: int, after: int) -> NDArray[Any]:
    """Cell data covers lines too, which come first, and volumes, which come last: zeros stand there."""
    return np.pad(values, [(before, after), *[(0, 0)] * (values.ndim - 1)]) if before or after else values


def _storable(values: NDArray[Any]) -> NDArray[Any]:
    """Values as VTK takes them: rows of numbers, no truth values."""
    typed = values.astype(np.uint8) if values.dtype == bool else values
    return np.ascontiguousarray(typed.reshape(len(typed), -1) if typed.ndim > 2 else typed)


def _bytes(arrays: Arrays, meta: Mapping[str, Any], style: Mapping[str, bool], *, legacy: bool) -> bytes:
    from vtkmodules import vtkIOLegacy, vtkIOXML

    kind = "UnstructuredGrid" if "cells.types" in arrays else "PolyData"
    data = _dataset(arrays, meta)
    with tempfile.TemporaryDirectory(prefix="pliant-") as folder:
        path = Path(folder, "mesh")
        room, name = (vtkIOLegacy, f"vtk{kind}Writer") if legacy else (vtkIOXML, f"vtkXML{kind}Writer")
        writer: Any = getattr(room, name)()
        writer.SetFileName(str(path))
        writer.SetInputData(data)
        if legacy:
            writer.SetFileTypeToASCII() if style["text"] else writer.SetFileTypeToBinary()
        else:
            writer.SetDataModeToAscii() if style["text"] else writer.SetDataModeToAppended()
            writer.SetEncodeAppendedData(not style["raw"])
            if not style["compressed"]:
                writer.SetCompressorTypeToNone()
        if not writer.Write() or writer.GetErrorCode():
            raise UnwritableFile(path, "VTK could not write it: is there room for temporary files?")
        return path.read_bytes()


def _dataset(arrays: Arrays, meta: Mapping[str, Any]) -> Any:
    """A vtkPolyData or vtkUnstructuredGrid that borrows the arrays."""
    from vtkmodules.util import numpy_support
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData, vtkUnstructuredGrid

    numpy_to_vtk: Callable[..., Any] = numpy_support.numpy_to_vtk
    data: Any = vtkUnstructuredGrid() if "cells.types" in arrays else vtkPolyData()
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(arrays["points"])))
    data.SetPoints(points)
    for name in ("cells",) if "cells.types" in arrays else CELLS:
        cells = vtkCellArray()
        pair = (arrays[f"{name}.{part}"].astype(np.int64, copy=False) for part in ("offsets", "flat"))
        cells.SetData(*(numpy_to_vtk(np.ascontiguousarray(each), deep=True) for each in pair))
        if name == "cells":
            data.SetCells(numpy_to_vtk(arrays["cells.types"], deep=True), cells)
        else:
            getattr(data, f"Set{name.capitalize()}")(cells)
    owners = {"point": data.GetPointData(), "cell": data.GetCellData(), "field": data.GetFieldData()}
    for kind, owner in owners.items():
        for i, name in enumerate(meta["names"][kind]):
            array = numpy_to_vtk(arrays[f"{kind}.{i}"])
            array.SetName(name)
            owner.AddArray(array)
        for word, name in meta["active"].get(kind, {}).items():
            getattr(owner, f"SetActive{word}")(name)
    return data
