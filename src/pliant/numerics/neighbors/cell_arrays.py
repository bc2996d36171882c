"""Voronoi cells as kernels take them: flat arrays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.neighbors.voronoi import VoronoiCells

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class CellArrays(NamedTuple):
    """Cells as kernels take them: positions, normals and corners flat; the rest as in :class:`VoronoiCells`.

    ``number`` is that of the cells, ``areas`` (f,) are the facets'.
    """

    number: int
    sites: Floats
    starts: Integers
    facets: NDArray[np.int32]
    owners: NDArray[np.int32]
    others: NDArray[np.int32]
    normals: Floats
    offsets: Floats
    areas: Floats
    corner_starts: Integers
    corners: Floats


def flat_cells(cells: VoronoiCells) -> CellArrays:
    """The cells as kernels take them."""
    return CellArrays(
        len(cells.sites), cells.sites.reshape(-1), cells.starts, cells.facets.astype(np.int32), cells.owners,
        cells.others, cells.normals.reshape(-1), cells.offsets, _areas(cells), cells.corner_starts,
        cells.corners.reshape(-1),
    )  # fmt: skip


def _areas(cells: VoronoiCells) -> Floats:
    """(f,) the facets' areas: fans of triangles about their first corners."""
    sizes = np.diff(cells.corner_starts)
    last = np.zeros(len(cells.corners), bool)
    last[cells.corner_starts[1:] - 1] = True
    following = np.arange(1, len(last) + 1)
    following[last] = cells.corner_starts[:-1]
    apart = cells.corners - np.repeat(cells.corners[cells.corner_starts[:-1]], sizes, axis=0)
    fans = np.add.reduceat(np.cross(apart, apart[following]), cells.corner_starts[:-1])
    return np.asarray(np.einsum("ij,ij->i", fans, cells.normals) / 2)
