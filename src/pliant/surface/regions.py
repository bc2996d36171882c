"""Regions of a mesh: sets of vertices, chosen in space or along the surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.numerics.meshes.geodesics import geodesic_distance
from pliant.numerics.meshes.graphs import grown
from pliant.surface.constraints import indices_in, mesh_of, vertex_set

Integers = NDArray[np.int64]


def sphere(mesh: PolygonMesh, center: ArrayLike, radius: float) -> Integers:
    """The vertices within a radius of a point (3,), ascending.

    Raises
    ------
    InvalidParameter
        A center that is not a point, or a radius that is not positive.
    """
    middle = np.asarray(center, np.float64)
    if middle.shape != (3,) or not np.isfinite(middle).all():
        raise InvalidParameter(f"a center is three numbers; given: {center!r}")
    return np.flatnonzero(np.linalg.norm(mesh.points - middle, axis=1) <= _positive(radius))


def geodesic_ball(mesh: PolygonMesh, vertices: ArrayLike, radius: float) -> Integers:
    """The vertices within a radius of some vertices, measured along the surface, ascending.

    Raises
    ------
    InvalidParameter
        No vertex to measure from, or a radius that is not positive.
    """
    mesh = mesh_of(mesh, "a geodesic radius")
    start = indices_in(mesh, vertex_set(vertices, "vertices"), "vertices")
    if not len(start):
        raise InvalidParameter("there is no vertex to measure from: name at least one")
    return np.flatnonzero(geodesic_distance(mesh.points, mesh.triangles, start) <= _positive(radius))


def grow(mesh: PolygonMesh, region: ArrayLike, rings: int = 1) -> Integers:
    """The region and the vertices within so many edges of it, ascending; fewer than none shrinks it."""
    if rings < 0:
        return shrink(mesh, region, -rings)
    return np.flatnonzero(grown(_graph(mesh), _mask(mesh, region), rings))


def shrink(mesh: PolygonMesh, region: ArrayLike, rings: int = 1) -> Integers:
    """The region without the vertices within so many edges of what is not in it, ascending."""
    if rings < 0:
        return grow(mesh, region, -rings)
    return np.flatnonzero(~grown(_graph(mesh), ~_mask(mesh, region), rings))


def belt(mesh: PolygonMesh, region: ArrayLike, rings: int = 1) -> Integers:
    """The vertices around a region, within so many edges of it: the anchors that an edit finds by itself."""
    inside = _mask(mesh, region)
    return np.flatnonzero(grown(_graph(mesh), inside, rings) & ~inside)


def _mask(mesh: PolygonMesh, region: ArrayLike) -> NDArray[np.bool_]:
    result = np.zeros(len(mesh.points), bool)
    result[indices_in(mesh, vertex_set(region, "region"), "region")] = True
    return result


def _graph(mesh: PolygonMesh) -> csr_array:
    neighbors = mesh.neighbors
    count = len(mesh.points)
    return csr_array((np.ones(len(neighbors.flat)), neighbors.flat, neighbors.offsets), shape=(count, count))


def _positive(radius: float) -> float:
    if not 0 < radius < np.inf:
        raise InvalidParameter(f"a radius is positive; given: {radius}")
    return radius
