"""Displacement fields as VTK image data, ``.vti``, or ``.vtk`` where it is read: VTK's grid transform, push-forward.

Displacements are the vectors of the points, in the file's own coordinates; beyond the image its border goes on.
"""

from __future__ import annotations

import re
import struct
from math import prod
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.files import write_bytes
from pliant.io.image_formats.orientation import split_matrix
from pliant.io.map_formats.displacement_images import required_grid
from pliant.io.map_formats.file_facts import FileFacts
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.io.map_formats.words import require_usable, spaced
from pliant.io.mesh_formats.format import Source
from pliant.io.mesh_formats.vtk_parts import require_vtk
from pliant.io.report import LossReport, refuse_losses
from pliant.space.displacement_grid import DisplacementGrid

Floats = NDArray[np.float64]

NAME = "VTK displacement field"
_EXTENT = re.compile(rb"WholeExtent\s*=\s*[\"']([-\d\s]+)[\"']")
_DIMENSIONS = re.compile(rb"\nDIMENSIONS\s+(\d+)\s+(\d+)\s+(\d+)", re.I)


def read(path: Path, data: bytes, options: ReadOptions) -> SpaceDeformer:
    """The map of a file, read in a process of its own.

    Raises
    ------
    UnreadableFile
        VTK cannot read it, or its numbers are not finite.
    UnsupportedFormat
        No vectors of three components at its points.
    MissingExtra
        VTK is not installed.
    """
    from pliant.io.mesh_formats import polydata_process

    options.require_physical(path)
    require_vtk("reading VTK files")
    if not data.startswith(b"# vtk") and not data.rstrip().endswith(b"</VTKFile>"):
        raise UnreadableFile(path, "the last line is not </VTKFile>", "the file is cut off", byte=len(data))
    shape = _shape(path, data)
    arrays, meta = polydata_process.read(Source(data, path), "ImageData")
    names, active = meta["names"]["point"], meta["active"]["point"]
    candidates = [active.get("Vectors"), active.get("Scalars"), *names]
    by_name = {name: arrays[f"point.{i}"] for i, name in enumerate(names)}
    vectors = next((by_name[name] for name in candidates if name in by_name and by_name[name].shape[1:] == (3,)), None)
    points = require_usable(path, arrays["points"], "positions")
    if vectors is None or len(vectors) != len(points) or prod(shape) != len(points):
        raise UnsupportedFormat(
            f"{path}: no image of vectors: {len(points):,} points with {', '.join(names) or 'nothing'}"
        )
    origin, spacing, axes = _frame(path, points, shape)
    return DisplacementGrid(
        displacements=require_usable(path, vectors, "displacements").reshape(*reversed(shape), 3).transpose(2, 1, 0, 3),
        origin=origin,
        spacing=spacing,
        axes=axes,
        outside="clamp",
        carrier=FileFacts(NAME),
    )


def _shape(path: Path, data: bytes) -> tuple[int, int, int]:
    """Numbers of points along each axis, from the header."""
    extent, dimensions = _EXTENT.search(data[:4096]), _DIMENSIONS.search(data[:4096])
    ends = [int(word[:12]) for word in extent[1].split()] if extent else []
    if len(ends) == 6:
        nx, ny, nz = (high - low + 1 for low, high in zip(ends[::2], ends[1::2], strict=True))
    elif dimensions:
        nx, ny, nz = (int(word[:9]) for word in dimensions.groups())
    else:
        raise UnreadableFile(path, "the header does not say how large the image is", "the file is damaged")
    if min(nx, ny, nz) < 1:
        raise UnreadableFile(path, f"the image has {(nx, ny, nz)} points", "the file is damaged")
    return nx, ny, nz


def _frame(path: Path, points: Floats, shape: tuple[int, int, int]) -> tuple[Floats, Floats, Floats]:
    """Origin, spacing and axes from the points, x fastest; a single axis of one point stands across the others."""
    grid = points.reshape(*reversed(shape), 3).transpose(2, 1, 0, 3)
    matrix = np.eye(4)
    matrix[:3, 3] = grid[0, 0, 0]
    along = [axis for axis in range(3) if shape[axis] > 1]
    for axis in along:
        place = [0, 0, 0]
        place[axis] = -1
        matrix[:3, axis] = (grid[tuple(place)] - grid[0, 0, 0]) / (shape[axis] - 1)
    if len(along) == 2:
        (flat,) = set(range(3)) - set(along)
        across = np.cross(matrix[:3, (flat + 1) % 3], matrix[:3, (flat + 2) % 3])
        matrix[:3, flat] = across / (np.linalg.norm(across) or 1.0)
    return split_matrix(path, matrix)


def write(deformer: Deformer, path: Path, *, strict: bool) -> LossReport:
    """Write a linear displacement grid as ``.vti``.

    Raises
    ------
    UnsupportedFormat
        Another deformer.
    """
    grid = required_grid(deformer, path, "VTK's image data")
    goes_on = grid.outside == "clamp" or not grid.displacements.any()
    losses = () if goes_on else ("that nothing moves beyond the grid: VTK lets its border go on",)
    refuse_losses(losses, path, strict=strict)
    extent = " ".join(f"0 {n - 1}" for n in grid.shape).encode()
    values = np.ascontiguousarray(grid.displacements.transpose(2, 1, 0, 3), "<f8").tobytes()
    head = (
        b'<?xml version="1.0"?>\n'
        b'<VTKFile type="ImageData" version="2.2" byte_order="LittleEndian" header_type="UInt64">\n'
        b'<ImageData WholeExtent="%b" Origin="%b" Spacing="%b" Direction="%b">\n<Piece Extent="%b">\n'
        b'<PointData Vectors="displacement">\n<DataArray type="Float64" Name="displacement" NumberOfComponents="3" '
        b'format="appended" offset="0"/>\n</PointData>\n</Piece>\n</ImageData>\n<AppendedData encoding="raw">\n_'
    ) % (extent, spaced(grid.origin), spaced(grid.spacing), spaced(grid.axes.reshape(-1)), extent)
    write_bytes(path, [head, struct.pack("<Q", len(values)), values, b"\n</AppendedData>\n</VTKFile>\n"])
    pulled = grid.direction != "push-forward"
    notes = ("the direction is not stored: readers take the map as 'push-forward'",) if pulled else ()
    return LossReport(path, NAME, losses, notes)
