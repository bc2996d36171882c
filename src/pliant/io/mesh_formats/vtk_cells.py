"""The numbers by which VTK knows its cells (vtkCellType.h), and the names that pliant gives to volumes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import PolygonMesh

LINE, POLYLINE, TRIANGLE, POLYGON, PIXEL, QUAD, POLYHEDRON = 3, 4, 5, 7, 8, 9, 42
FACES = (TRIANGLE, POLYGON, PIXEL, QUAD)
LINES = (LINE, POLYLINE)
CELL_TYPES = {
    10: ("tetra", 4),
    11: ("voxel", 8),
    12: ("hexahedron", 8),
    13: ("wedge", 6),
    14: ("pyramid", 5),
    21: ("line3", 3),
    22: ("triangle6", 6),
    23: ("quad8", 8),
    24: ("tetra10", 10),
    25: ("hexahedron20", 20),
    26: ("wedge15", 15),
    27: ("pyramid13", 13),
    28: ("quad9", 9),
    29: ("hexahedron27", 27),
}
_NUMBERS = {name: number for number, (name, _) in CELL_TYPES.items()}


def cells_of(mesh: PolygonMesh) -> tuple[dict[str, NDArray[Any]], tuple[str, ...]]:
    """The arrays of a mesh's cells: lines, faces, volumes; and the volumes that VTK does not know, as losses."""
    parts = list(_parts(mesh))
    lengths = np.concatenate([np.full(0, 0), *(lengths for _, lengths, _ in parts)])
    arrays = {
        "cells.types": np.concatenate([np.empty(0, np.uint8), *(types for types, _, _ in parts)]),
        "cells.offsets": np.concatenate([[0], np.cumsum(lengths)]),
        "cells.flat": np.concatenate([np.empty(0, np.int64), *(flat for _, _, flat in parts)]),
    }
    unknown = tuple(
        f"{len(rows):,} cells of the kind {kind!r}" for kind, rows in mesh.cells.items() if not _is_known(kind, rows)
    )
    return arrays, unknown


def _is_known(kind: str, rows: NDArray[np.int32]) -> bool:
    return kind in _NUMBERS and CELL_TYPES[_NUMBERS[kind]][1] == rows.shape[1]


def _parts(mesh: PolygonMesh) -> Iterator[tuple[NDArray[np.uint8], NDArray[np.int64], NDArray[np.int32]]]:
    """Types, lengths and indices of each part."""
    if mesh.lines is not None:
        lengths = mesh.lines.lengths
        yield np.where(lengths == 2, LINE, POLYLINE).astype(np.uint8), lengths, mesh.lines.flat
    sides = mesh.faces.lengths
    yield np.select([sides == 3, sides == 4], [TRIANGLE, QUAD], POLYGON).astype(np.uint8), sides, mesh.faces.flat
    for kind, rows in mesh.cells.items():
        if _is_known(kind, rows):
            yield np.full(len(rows), _NUMBERS[kind], np.uint8), np.full(len(rows), rows.shape[1]), rows.ravel()
