"""A process of its own that reads one VTK file, so that a damaged one harms nobody.

VTK's readers may crash, or ask for memory without end, on a file that lies about its sizes. Called as
``python -m pliant.io.polydata_child FILE OUT BYTES SECONDS``: OUT receives a line of JSON with the arrays' names, and
the arrays one after another as .npy; what VTK complains of goes to the standard error.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

CELLS = ("verts", "lines", "polys", "strips")
REFUSED = 3


def main(path: str, out: str, memory: int, seconds: int) -> int:
    """Read a file within limits; returns the exit code."""
    _limit(memory, seconds)
    from vtkmodules.util import numpy_support
    from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
    from vtkmodules.vtkIOLegacy import vtkPolyDataReader
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    vtk_to_numpy: Callable[[Any], NDArray[Any]] = numpy_support.vtk_to_numpy
    window = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    with Path(path).open("rb") as stream:
        legacy = stream.read(5).startswith(b"# vtk")
    reader = vtkPolyDataReader() if legacy else vtkXMLPolyDataReader()
    reader.SetFileName(path)
    if legacy:
        for every in ("Scalars", "Vectors", "Normals", "TCoords", "Tensors", "ColorScalars", "Fields"):
            getattr(reader, f"ReadAll{every}On")()
    reader.Update()
    complaint = window.GetOutput()
    if reader.GetErrorCode() or "ERR" in complaint or "Error" in complaint:
        sys.stderr.write(complaint)
        return REFUSED
    data = reader.GetOutput()
    arrays: dict[str, NDArray[Any]] = {}
    points = data.GetPoints()
    arrays["points"] = vtk_to_numpy(points.GetData()) if points else np.empty((0, 3))
    for name in CELLS:
        cells = getattr(data, f"Get{name.capitalize()}")()
        arrays[f"{name}.offsets"] = vtk_to_numpy(cells.GetOffsetsArray())
        arrays[f"{name}.flat"] = vtk_to_numpy(cells.GetConnectivityArray())
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
    with Path(out).open("wb") as stream:
        stream.write(json.dumps({**meta, "arrays": list(arrays)}).encode() + b"\n")
        for array in arrays.values():
            np.save(stream, array, allow_pickle=False)
    return 0


def _limit(memory: int, seconds: int) -> None:
    try:
        import resource
    except ImportError:  # Windows has no such limits; the parent's time-out still holds
        return
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])))
