"""The corners and edges of Voronoi cells: which facets hang together where, and what an edge gives to their areas."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.neighbors.voronoi import VoronoiCells

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

SAME_CORNER = 1e-11  # of the largest coordinate: below it, corners of facets are one


class Skeleton(NamedTuple):
    """Corners of c places, and the edges between them, once from either end, as kernels take them.

    Parameters
    ----------
    anchors, places
        (c,) the first site whose cell has the corner; (3 c,) where it is, relative to that site.
    starts, ends
        (c + 1,) where each corner's edges start; (e,) the corner that an edge leads to.
    side_starts, sides, triangles
        (e + 1,) where each edge's facets start; (s,) twice the facet, plus one if its outline runs along the edge and
        not against it; (s,) the area of the triangle between the edge and the facet's nearest corner.
    nearest
        (3 f,) each facet's corner nearest to its owner, relative to that.
    cell_starts, cell_corners
        (m + 1,) where each cell's corners start; which they are.
    """

    anchors: NDArray[np.int32]
    places: Floats
    starts: Integers
    ends: NDArray[np.int32]
    side_starts: Integers
    sides: NDArray[np.int32]
    triangles: Floats
    nearest: Floats
    cell_starts: Integers
    cell_corners: NDArray[np.int32]

    @classmethod
    def of(cls, cells: VoronoiCells) -> Skeleton:
        """Corners and edges of cells."""
        sizes = np.diff(cells.corner_starts)
        facets = np.repeat(np.arange(len(sizes)), sizes)
        corners = _met(cells.corners + cells.sites[cells.owners[facets]])
        first = np.unique(corners, return_index=True)[1]  # owners ascend
        distances = (cells.corners**2).sum(axis=1)  # triangles with far corners would cancel where facets are long
        nearest = cells.corners[np.lexsort([distances, facets])[cells.corner_starts[:-1]]]
        following = np.arange(1, len(corners) + 1)
        following[cells.corner_starts[1:] - 1] = cells.corner_starts[:-1]
        apart = cells.corners - nearest[facets]
        areas = np.einsum("ij,ij->i", np.cross(apart, apart[following]), cells.normals[facets]) / 2
        return cls(
            cells.owners[facets[first]],
            cells.corners[first].reshape(-1),
            *_edges(corners, corners[following], facets, areas),
            nearest.reshape(-1),
            *_of_cells(cells, facets, corners),
        )


def _edges(
    here: Integers, there: Integers, facets: Integers, areas: Floats
) -> tuple[Integers, NDArray[np.int32], Integers, NDArray[np.int32], Floats]:
    """From facets' outlines, corner to corner, to ``starts``, ``ends``, ``side_starts``, ``sides``, ``triangles``."""
    count, long = int(here.max()) + 1, here != there
    here, there, codes, areas = here[long], there[long], 2 * facets[long], areas[long]
    here, there = np.concatenate([here, there]), np.concatenate([there, here])
    order = np.lexsort([there, here])
    here, there = here[order], there[order]
    begins = np.flatnonzero((np.diff(here, prepend=-1) != 0) | (np.diff(there, prepend=-1) != 0))
    return (
        np.searchsorted(here[begins], np.arange(count + 1)),
        there[begins].astype(np.int32),
        np.append(begins, len(order)),
        np.concatenate([codes + 1, codes])[order].astype(np.int32),
        np.concatenate([areas, areas])[order],
    )


def _met(places: Floats) -> Integers:
    """(n,) which of (n, 3) places are the same, by number."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    pairs = cKDTree(places).query_pairs(SAME_CORNER * float(np.abs(places).max()), output_type="ndarray")
    graph = coo_array((np.ones(len(pairs), bool), pairs.T), shape=(len(places), len(places)))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)


def _of_cells(cells: VoronoiCells, facets: Integers, corners: Integers) -> tuple[Integers, NDArray[np.int32]]:
    """Where each cell's corners start, and which they are."""
    owners, others, count = cells.owners[facets].astype(np.int64), cells.others[facets].astype(np.int64), len(corners)
    shared = others >= 0
    pairs = np.concatenate([owners * count + corners, others[shared] * count + corners[shared]])
    users, of_users = np.divmod(np.unique(pairs), count)
    return np.searchsorted(users, np.arange(len(cells.sites) + 1)), of_users.astype(np.int32)
