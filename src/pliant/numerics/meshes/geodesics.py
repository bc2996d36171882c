"""Distance along a surface by the heat method (Crane, Weischedel & Wardetzky 2013)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.meshes.adjacency import unique_edges
from pliant.numerics.meshes.graphs import components, edge_graph, nearest_source
from pliant.numerics.ragged import Ragged

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


def geodesic_distance(points: Floats, triangles: NDArray[np.int32], sources: Integers) -> Floats:
    """(n,) the distance of each vertex to the nearest source; infinite where no path leads.

    Parameters
    ----------
    points, triangles
        (n, 3) and (t, 3); degenerate and non-manifold triangles will do.
    sources
        (k,) vertices, at least one.
    """
    graph = edge_graph(points, unique_edges(Ragged.of(triangles)))
    along, _ = nearest_source(graph, sources)
    a, b, c = triangles.T
    proper = triangles[(a != b) & (b != c) & (c != a)]
    used, compact = np.unique(proper, return_inverse=True)
    label = components(graph)
    result = along
    for component in np.unique(label[np.intersect1d(sources, used)]):
        inside = label[used[compact.reshape(-1, 3)[:, 0]]] == component
        result = _heat(points, proper[inside], sources, result)
    return result


def _heat(points: Floats, triangles: NDArray[np.int32], sources: Integers, along: Floats) -> Floats:
    """Distances along edges replaced by the heat method's in one component, where it gives sensible ones."""
    import potpourri3d

    used, compact = np.unique(triangles, return_inverse=True)
    near = np.flatnonzero(np.isin(used, sources))
    try:
        solver = potpourri3d.MeshHeatMethodDistanceSolver(points[used], compact.reshape(-1, 3))
        distance = np.asarray(solver.compute_distance_multisource(near.tolist()), np.float64)
    except RuntimeError:
        return along  # triangles without any area: the distance along edges stands
    if not np.isfinite(distance).all():
        return along
    result = along.copy()
    result[used] = np.clip(distance, 0.0, along[used])  # a path along edges is never shorter
    result[sources] = 0.0
    return result
