"""Cutting a mesh by planes: the loop where a plane passes through one limb, of all the loops that it gives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.meshes.manifold import pieces

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True)
class Cut:
    """A plane, (3,) origin and (3,) unit normal."""

    origin: Floats
    normal: Floats


@dataclass(frozen=True)
class Loop:
    """Where a plane passes through a limb: (k, 3) points on its section, and the edges that they lie on."""

    points: Points
    edges: Indices


def cut_loop(mesh: PolygonMesh, edges: Indices, cut: Cut, number: int) -> Loop:
    """The piece of a plane's section around the plane's origin, or nearest to it; of nested ones the outermost.

    Raises
    ------
    InvalidParameter
        The plane misses the mesh.
    """
    return section(mesh.points, mesh.triangles.astype(np.int64), edges, cut, number)


def section(points: Points, triangles: Indices, edges: Indices, cut: Cut, number: int) -> Loop:
    """The same of (t, 3) triangles whose (e, 2) edges are known."""
    height = (points - cut.origin) @ cut.normal
    above = height >= 0
    crossing = np.flatnonzero(above[edges[:, 0]] != above[edges[:, 1]])
    if not len(crossing):
        raise InvalidParameter(f"cut {number} misses the mesh: move its origin into the limb that it shall cut")
    a, b = edges[crossing].T
    part = height[a] / (height[a] - height[b])
    places = points[a] + part[:, None] * (points[b] - points[a])
    segments = _segments(len(points), triangles, edges, crossing)
    count, piece = pieces(segments, len(crossing))
    distance = np.linalg.norm(places - cut.origin, axis=1)
    near, reach = np.full(count, np.inf), np.zeros(count)
    np.minimum.at(near, piece, distance)
    np.maximum.at(reach, piece, distance)
    around = _around(places, segments, piece, count, cut)
    near[around] = 0.0
    reach[near > near.min()] = -1.0
    chosen = piece == reach.argmax()  # of those around the origin, the one that goes farthest
    return Loop(places[chosen], crossing[chosen])


def triangle_edges(mesh: PolygonMesh) -> Indices:
    """(e, 2) the edges of the mesh's triangles, each once."""
    return edges_of(mesh.triangles)


def edges_of(triangles: NDArray[np.integer]) -> Indices:
    """(e, 2) the edges of triangles, each once, sorted."""
    ends = np.sort(half_edges_of(triangles), axis=1)
    count = int(triangles.max(initial=0)) + 1
    codes = np.sort(ends[:, 0] * count + ends[:, 1])
    first = np.append(True, codes[1:] != codes[:-1])[: len(codes)]
    return np.stack(np.divmod(codes[first], count), axis=1)


def half_edges_of(triangles: NDArray[np.integer]) -> Indices:
    """(3 t, 2) the sides of triangles in their directions."""
    whole = triangles.astype(np.int64)
    return np.stack([whole, np.roll(whole, -1, axis=1)], axis=2).reshape(-1, 2)


def edge_places(count: int, edges: Indices, half: Indices) -> Indices:
    """(h,) where among sorted edges of ``count`` vertices each half edge is."""
    ends = np.sort(half, axis=1)
    return np.searchsorted(edges[:, 0] * count + edges[:, 1], ends[:, 0] * count + ends[:, 1])


def _segments(count: int, triangles: Indices, edges: Indices, crossing: Indices) -> Indices:
    """(k, 2) pairs of crossing edges that share a triangle."""
    place = np.full(len(edges), -1)
    place[crossing] = np.arange(len(crossing))
    sides = place[edge_places(count, edges, half_edges_of(triangles))].reshape(-1, 3)
    pairs = np.concatenate([sides[:, [0, 1]], sides[:, [1, 2]], sides[:, [2, 0]]])
    return pairs[(pairs >= 0).all(axis=1)]


def _around(places: Points, segments: Indices, piece: Indices, count: int, cut: Cut) -> NDArray[np.bool_]:
    """(count,) which pieces have the origin inside: a ray from it meets an odd number of their segments."""
    first, second = axes_across(cut.normal)
    u, v = (places - cut.origin) @ first, (places - cut.origin) @ second
    (a, b), (c, d) = u[segments].T, v[segments].T
    crosses = (c > 0) != (d > 0)
    along = a[crosses] - c[crosses] * (b[crosses] - a[crosses]) / (d[crosses] - c[crosses])
    met = piece[segments[:, 0][crosses]][along > 0]
    return np.asarray(np.bincount(met, minlength=count) % 2 == 1)


def axes_across(normal: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors across a normal, the first as near as can be to a coordinate axis."""
    axis = np.eye(3)[np.abs(normal).argmin()]
    first = axis - (axis @ normal) * normal
    first /= np.linalg.norm(first)
    return first, np.cross(normal, first)
