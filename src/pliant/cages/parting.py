"""A mesh parted along loops: its triangles are split where planes pass through limbs, and fall into regions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.cages.sections import Cut, edge_places, edges_of, half_edges_of, section
from pliant.cages.splitting import Split, beside, loops_apart, regions_between, split
from pliant.errors import InvalidParameter, InvalidTarget
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.coordinates.winding import signed_volume
from pliant.numerics.meshes.manifold import pieces

Indices = NDArray[np.int64]

_ENOUGH = 6000  # triangles: a coarser mesh is cut finer first


@dataclass(frozen=True)
class Parts:
    """The regions that cuts make of a surface.

    Parameters
    ----------
    points, triangles
        The surface, holes closed and split along the loops.
    region
        (t,) the region of each triangle.
    rims
        For each cut the vertices on its loop, in order, counter-clockwise about its normal.
    sides
        (c, 2) for each cut the region below and above its plane.
    """

    points: Points
    triangles: Indices
    region: Indices
    rims: tuple[Indices, ...]
    sides: Indices

    def inside(self, region: int) -> Points:
        """The points of a region."""
        return np.asarray(self.points[np.unique(self.triangles[self.region == region])])

    def of_vertices(self, count: int) -> Indices:
        """(count,) the region of each of the first vertices, which are the mesh's; -1 where it has no faces."""
        found = np.full(len(self.points), -1)
        found[self.triangles] = self.region[:, None]
        return found[:count]


def parted(mesh: PolygonMesh, cuts: tuple[Cut, ...]) -> Parts:
    """Part a mesh along cuts, each of which passes through one limb.

    Raises
    ------
    InvalidParameter
        A cut that misses the mesh, crosses another one on it, or does not separate two regions.
    InvalidTarget
        A piece of the mesh that no cut passes through.
    """
    found = Split(*_surface(mesh))
    for number, cut in enumerate(cuts):
        found = _cut(found, cut, number)
    region = regions_between(found)
    sides = np.array([beside(found, region, rim) for rim in found.rims])
    idle = np.flatnonzero(sides[:, 0] == sides[:, 1])
    if len(idle):
        raise InvalidParameter(f"cut {idle[0]} separates nothing: a handle needs two cuts, or one more elsewhere")
    missed = np.setdiff1d(region, sides)
    if len(missed):
        first = int(found.triangles[region == missed[0]].min())
        raise InvalidTarget(
            f"{len(missed)} pieces of the mesh are cut by no plane, the first holds vertex {first}: cut them too, or "
            "leave them out"
        )
    return Parts(found.points, found.triangles, region, found.rims, sides)


def _surface(mesh: PolygonMesh) -> tuple[Points, Indices]:
    """The triangles of a mesh, oriented outwards, holes closed by fans; cut finer where they are few."""
    points, triangles = mesh.points, mesh.triangles.astype(np.int64)
    half = half_edges_of(triangles)
    known = half[:, 0] * len(points) + half[:, 1]
    rim = half[~np.isin(half[:, 1] * len(points) + half[:, 0], known)]
    if len(rim):
        used, ends = np.unique(rim, return_inverse=True)
        count, piece = pieces(ends.reshape(-1, 2), len(used))
        sums = np.stack([np.bincount(piece, points[used, i], count) for i in range(3)], axis=1)
        hub = len(points) + piece[ends.reshape(-1, 2)[:, 0]]
        points = np.concatenate([points, sums / np.bincount(piece, minlength=count)[:, None]])
        triangles = np.concatenate([triangles, np.column_stack([rim[:, 1], rim[:, 0], hub])])
    outwards = signed_volume(points, triangles) >= 0
    return _finer(points, triangles if outwards else triangles[:, ::-1], _ENOUGH)


def _finer(points: Points, triangles: Indices, enough: int) -> tuple[Points, Indices]:
    """Triangles cut into four at the middles of their sides, until there are enough."""
    while len(triangles) < enough:
        edges = edges_of(triangles)
        middle = len(points) + edge_places(len(points), edges, half_edges_of(triangles)).reshape(-1, 3)
        (a, b, c), (ab, bc, ca) = triangles.T, middle.T
        pieces_of = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
        points = np.concatenate([points, points[edges].mean(axis=1)])
        triangles = np.concatenate([np.column_stack(each) for each in pieces_of])
    return points, triangles


def _cut(found: Split, cut: Cut, number: int) -> Split:
    """The surface with a cut's loop as edges."""
    edges = edges_of(found.triangles)
    loop = section(found.points, found.triangles, edges, cut, number)
    if not loops_apart(found, edges, loop):
        raise InvalidParameter(f"cut {number} crosses an earlier one on the mesh: move one, or turn it")
    after = split(found, edges, loop, cut)
    if after is None:
        raise InvalidParameter(f"cut {number} passes where the mesh is no manifold: move it along its limb")
    return after
