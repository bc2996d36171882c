"""Questions about who is connected to whom."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, dijkstra

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


def components(graph: csr_array) -> NDArray[np.int32]:
    """(n,) the connected component of each vertex of an (n, n) symmetric sparse graph."""
    return np.asarray(connected_components(graph, directed=False)[1], np.int32)


def edge_graph(points: Floats, edges: NDArray[np.int32]) -> csr_array:
    """(n, n) lengths of (e, 2) edges; an edge of no length keeps a trace, so that it still connects."""
    length = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    length = np.maximum(length, 1e-12 * float(length.max(initial=1e-300)))
    row, column = np.concatenate([edges, edges[:, ::-1]]).T
    return csr_array((np.tile(length, 2), (row, column)), shape=(len(points), len(points)))


def nearest_source(graph: csr_array, sources: Integers) -> tuple[Floats, Integers]:
    """(n,) the distance along edges to the nearest source, infinite where there is none, and that source, or -1."""
    distance, _, source = dijkstra(graph, indices=sources, min_only=True, return_predecessors=True)
    found = np.where(np.isfinite(distance), source, -1)
    return np.asarray(distance), found.astype(np.int64)


def grown(graph: csr_array, chosen: NDArray[np.bool_], rings: int) -> NDArray[np.bool_]:
    """(n,) the chosen vertices and those within so many edges of them."""
    pattern = csr_array((np.ones(graph.nnz, np.int8), graph.indices, graph.indptr), shape=graph.shape)
    result = chosen.copy()
    for _ in range(rings):
        wider = result | ((pattern @ result.astype(np.int32)) > 0)
        if np.array_equal(wider, result):  # all that can be reached
            break
        result = wider
    return result
