"""Distance along a surface by the heat method (Crane, Weischedel & Wardetzky 2013)."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import cached_property
from threading import Lock

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from pliant.errors import SingularSystem
from pliant.numerics.meshes.adjacency import unique_edges
from pliant.numerics.meshes.graphs import components, edge_graph, nearest_source
from pliant.numerics.meshes.heat import HeatDistances
from pliant.numerics.ragged import Ragged

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_MANY = 40_000  # triangles: up to here, they are exchanged for an intrinsic Delaunay triangulation first


def geodesic_distance(points: Floats, triangles: NDArray[np.int32], sources: Integers) -> Floats:
    """(n,) the distance of each vertex to the nearest source; infinite where no path leads.

    Parameters
    ----------
    points, triangles
        (n, 3) and (t, 3); degenerate and non-manifold triangles will do.
    sources
        (k,) vertices, at least one.
    """
    return GeodesicDistances(points, triangles)(sources)


class GeodesicDistances:
    """Distances along one surface from any sources: what depends on the surface only is computed once. Thread-safe.

    Parameters
    ----------
    points, triangles
        (n, 3) and (t, 3); degenerate and non-manifold triangles will do.

    Attributes
    ----------
    ready
        Whether all of that is there.
    """

    def __init__(self, points: Floats, triangles: NDArray[np.int32]) -> None:
        self._points, self._triangles = points, triangles
        a, b, c = triangles.T
        self._proper = triangles[(a != b) & (b != c) & (c != a)]
        self._known: dict[int, _Component] = {}
        self.ready = False
        self._lock = Lock()

    @cached_property
    def _graph(self) -> csr_array:
        return edge_graph(self._points, unique_edges(Ragged.of(self._triangles)))

    @cached_property
    def _label(self) -> NDArray[np.int32]:
        return components(self._graph)

    def __call__(self, sources: Integers) -> Floats:
        """(n,) the distance of each vertex to the nearest of (k,) sources; infinite where no path leads."""
        along, _ = nearest_source(self._graph, sources)
        result = along.copy()
        for number in np.unique(self._label[sources]):
            part = self.component(int(number))
            distance = part.distance(sources)
            if distance is not None:
                result[part.used] = np.clip(distance, 0.0, along[part.used])  # a path along edges is never shorter
        result[sources] = 0.0
        return result

    def prepare(self) -> None:
        """Compute now what does not depend on the sources."""
        for number in np.unique(self._label[self._proper[:, 0]]):
            self.component(int(number))
        self.ready = True

    def component(self, number: int) -> _Component:
        """What is connected."""
        with self._lock:
            if number not in self._known:
                inside = self._label[self._proper[:, 0]] == number
                self._known[number] = _Component(self._points, self._proper[inside])
            return self._known[number]


class _Component:
    """A connected part: its vertices, and the heat method on it where that gives sensible distances."""

    def __init__(self, points: Floats, triangles: NDArray[np.int32]) -> None:
        used, compact = np.unique(triangles, return_inverse=True)
        self.used = used
        self._solver: Callable[[Integers], Floats] | None = None
        if len(triangles):
            with suppress(RuntimeError, SingularSystem):  # without any area, distances along edges stand
                self._solver = _solver(points[used], compact.reshape(-1, 3).astype(np.int32))

    def distance(self, sources: Integers) -> Floats | None:
        """(u,) for each of its vertices; None where there is nothing better than distances along edges."""
        near = np.flatnonzero(np.isin(self.used, sources))
        if self._solver is None or not len(near):
            return None
        try:
            found = self._solver(near)
        except RuntimeError:
            return None
        return found if np.isfinite(found).all() else None


def _solver(points: Floats, triangles: NDArray[np.int32]) -> Callable[[Integers], Floats]:
    if len(triangles) > _MANY:
        return HeatDistances(points, triangles)
    import potpourri3d

    solver = potpourri3d.MeshHeatMethodDistanceSolver(points, triangles)
    return lambda near: np.asarray(solver.compute_distance_multisource(near.tolist()), np.float64)
