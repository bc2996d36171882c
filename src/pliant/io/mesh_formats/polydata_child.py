"""A process of its own that reads one VTK file, so that a damaged one harms nobody.

VTK's readers may crash, or ask for memory without end, on a file that lies about its sizes. Called as
``python -m pliant.io.mesh_formats.polydata_child FILE OUT KIND BYTES SECONDS``: KIND is what VTK's classes call it,
OUT receives a line of JSON with the arrays' names, and the arrays one after another as .npy; what VTK complains of
goes to the standard error.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

CELLS = ("verts", "lines", "polys", "strips")
REFUSED = 3
_MAPPED, _LEAST = 2200 << 20, 800 << 20  # bytes of address space that libraries map; of memory that all may take


def main(path: str, out: str, kind: str, memory: int, seconds: int) -> int:
    """Read a file within limits; returns the exit code."""
    limit(memory, seconds)
    from vtkmodules.util import numpy_support
    from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow

    vtk_to_numpy: Callable[[Any], NDArray[Any]] = numpy_support.vtk_to_numpy
    window = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    reader: Any = _reader(path, kind)
    reader.SetFileName(path)
    if hasattr(reader, "ReadAllScalarsOn"):
        for every in ("Scalars", "Vectors", "Normals", "TCoords", "Tensors", "ColorScalars", "Fields"):
            getattr(reader, f"ReadAll{every}On")()
    reader.Update()
    complaint = window.GetOutput()
    if reader.GetErrorCode() or "ERR" in complaint or "Error" in complaint:
        sys.stderr.write(complaint)
        return REFUSED
    data = reader.GetOutput()
    arrays = _shape(data, kind, vtk_to_numpy)
    meta: dict[str, Any] = {"skipped": [], "names": {}, "active": {}}
    for kind, fields in (("point", data.GetPointData()), ("cell", data.GetCellData()), ("field", data.GetFieldData())):
        names: list[str] = []
        meta["names"][kind] = names
        for i in range(fields.GetNumberOfArrays()):
            array = fields.GetArray(i)
            if array is None:  # text
                meta["skipped"].append(str(fields.GetAbstractArray(i).GetName()))
                continue
            arrays[f"{kind}.{len(names)}"] = vtk_to_numpy(array)
            names.append(array.GetName() or f"{kind}{i}")
        if kind != "field":
            active = {word: getattr(fields, f"Get{word}")() for word in ("Scalars", "Vectors", "Normals", "TCoords")}
            meta["active"][kind] = {word: array.GetName() for word, array in active.items() if array}
    hand_over(out, arrays, meta)
    return 0


def hand_over(out: str, arrays: dict[str, NDArray[Any]], meta: dict[str, Any]) -> None:
    """Leave the arrays and what they are called for the process that waits for them."""
    with Path(out).open("wb") as stream:
        stream.write(json.dumps({**meta, "arrays": list(arrays)}).encode() + b"\n")
        for array in arrays.values():
            np.save(stream, array, allow_pickle=False)


def _reader(path: str, kind: str) -> Any:
    from vtkmodules import vtkIOLegacy, vtkIOXML

    with Path(path).open("rb") as stream:
        legacy = stream.read(5).startswith(b"# vtk")
    if legacy and kind == "ImageData":
        return vtkIOLegacy.vtkStructuredPointsReader()
    return getattr(vtkIOLegacy, f"vtk{kind}Reader")() if legacy else getattr(vtkIOXML, f"vtkXML{kind}Reader")()


def _shape(data: Any, kind: str, to_numpy: Callable[[Any], NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Points and cells; grids have points alone."""
    if kind in ("ImageData", "RectilinearGrid"):
        return {"points": _grid(data, kind, to_numpy)}
    points = data.GetPoints()
    arrays = {"points": to_numpy(points.GetData()) if points else np.empty((0, 3))}
    owners = {name: getattr(data, f"Get{name.capitalize()}") for name in CELLS} if kind == "PolyData" else {}
    if kind == "UnstructuredGrid":
        owners = {"cells": data.GetCells}
        arrays["cells.types"] = to_numpy(data.GetCellTypesArray())
    for name, cells in owners.items():
        arrays[f"{name}.offsets"] = to_numpy(cells().GetOffsetsArray())
        arrays[f"{name}.flat"] = to_numpy(cells().GetConnectivityArray())
    return arrays


def _grid(data: Any, kind: str, to_numpy: Callable[[Any], NDArray[Any]]) -> NDArray[Any]:
    """(n, 3) the points that a grid implies, x fastest."""
    if kind == "RectilinearGrid":
        axes = [to_numpy(getattr(data, f"Get{axis}Coordinates")()) for axis in "XYZ"]
        return np.stack(np.meshgrid(*axes[::-1], indexing="ij")[::-1], axis=-1).reshape(-1, 3)
    extent = data.GetExtent()
    spans = [np.arange(low, high + 1.0) for low, high in zip(extent[::2], extent[1::2], strict=True)]
    index = np.stack(np.meshgrid(*spans[::-1], indexing="ij")[::-1], axis=-1).reshape(-1, 3)
    matrix = data.GetIndexToPhysicalMatrix()
    table = np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(3)])
    points: NDArray[Any] = index @ table[:, :3].T + table[:, 3]
    return points


class Refused(Exception):
    """What a reading process has against a file, in words."""


@contextmanager
def refusing() -> Iterator[None]:
    """End the process with one line on the standard error, whatever is raised."""
    try:
        yield
    except Exception as error:  # whatever a library says of a damaged file
        try:
            said = " ".join(str(error).split())
        except UnicodeDecodeError:  # libraries quote bytes of the file
            said = type(error).__name__
        sys.stderr.write(f"\nError: {said}\n")
        sys.exit(REFUSED)


def limit(memory: int, seconds: int) -> None:
    """Bound what this process may take of memory and time."""
    try:
        import resource
    except ImportError:  # Windows has no such limits; the parent's time-out still holds
        return
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    if sys.platform == "linux":  # there it bounds what is written to, not what libraries map
        data = max(_LEAST, memory - _MAPPED)
        resource.setrlimit(resource.RLIMIT_DATA, (data, data))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4]), int(sys.argv[5])))
