"""A mesh parted along loops: its triangles are split where planes pass through limbs, and fall into regions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.cages.sections import Cut, edge_places, edges_of, half_edges_of, section
from pliant.errors import InvalidParameter, InvalidTarget
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.coordinates.winding import signed_volume
from pliant.numerics.meshes.manifold import pieces

Indices = NDArray[np.int64]

_ENOUGH = 6000  # triangles: a coarser mesh is cut finer first
_OFF = 1e-4  # of an edge: how near to its ends it is split at the most


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
    points, triangles = _surface(mesh)
    rims: list[Indices] = []
    for number, cut in enumerate(cuts):
        points, triangles, rim = _split(points, triangles, cut, number, rims)
        rims.append(rim)
    region = _regions(len(points), triangles, rims)
    sides = np.array([_sides(len(points), triangles, region, rim) for rim in rims])
    idle = np.flatnonzero(sides[:, 0] == sides[:, 1])
    if len(idle):
        raise InvalidParameter(f"cut {idle[0]} separates nothing: a handle needs two cuts, or one more elsewhere")
    missed = np.setdiff1d(region, sides)
    if len(missed):
        first = int(triangles[region == missed[0]].min())
        raise InvalidTarget(
            f"{len(missed)} pieces of the mesh are cut by no plane, the first holds vertex {first}: cut them too, or "
            "leave them out"
        )
    return Parts(points, triangles, region, tuple(rims), sides)


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
    return finer(points, triangles if outwards else triangles[:, ::-1], _ENOUGH)


def finer(points: Points, triangles: Indices, enough: int) -> tuple[Points, Indices]:
    """Triangles cut into four at the middles of their sides, until there are enough."""
    while len(triangles) < enough:
        edges = edges_of(triangles)
        middle = len(points) + edge_places(len(points), edges, half_edges_of(triangles)).reshape(-1, 3)
        (a, b, c), (ab, bc, ca) = triangles.T, middle.T
        pieces_of = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
        points = np.concatenate([points, points[edges].mean(axis=1)])
        triangles = np.concatenate([np.column_stack(each) for each in pieces_of])
    return points, triangles


def _split(
    points: Points, triangles: Indices, cut: Cut, number: int, rims: list[Indices]
) -> tuple[Points, Indices, Indices]:
    """The surface with a cut's loop as edges, and the loop."""
    edges = edges_of(triangles)
    loop = section(points, triangles, edges, cut, number)
    for other, rim in enumerate(rims):
        steps = np.stack([rim, np.roll(rim, -1)], axis=1)
        if np.isin(edge_places(len(points), edges, steps), loop.edges).any():
            raise InvalidParameter(f"cuts {other} and {number} cross one another on the mesh: move one, or turn it")
    height = (points - cut.origin) @ cut.normal
    a, b = edges[loop.edges].T
    part = np.clip(height[a] / (height[a] - height[b]), _OFF, 1 - _OFF)
    fresh = np.full(len(edges), -1)
    fresh[loop.edges] = len(points) + np.arange(len(loop.edges))
    sides = fresh[edge_places(len(points), edges, half_edges_of(triangles))].reshape(-1, 3)
    through = (sides >= 0).any(axis=1)
    whole, sides = triangles[through], sides[through]
    lone = (sides < 0).argmax(axis=1)  # the side that is not cut; opposite is the corner that is alone
    turn = (lone[:, None] + [2, 0, 1]) % 3
    whole, sides = np.take_along_axis(whole, turn, 1), np.take_along_axis(sides, turn, 1)
    (tip, left, right), (out, _, back) = whole.T, sides.T
    pieces_of = [np.column_stack(each) for each in ((tip, out, back), (out, left, right), (out, right, back))]
    points = np.concatenate([points, points[a] + part[:, None] * (points[b] - points[a])])
    # seen from outside with the normal up, counter-clockwise is from the left to the right
    steps = np.where((height[tip] >= 0)[:, None], np.column_stack([out, back]), np.column_stack([back, out]))
    rim = traced(steps)
    if len(rim) != len(steps):
        raise InvalidParameter(f"cut {number} passes where the mesh is no manifold: move it along its limb")
    return points, np.concatenate([triangles[~through], *pieces_of]), rim


def traced(steps: Indices) -> Indices:
    """The loop that (k, 2) directed steps make from the first one on; shorter, where they make no single loop."""
    following = dict(steps.tolist())
    loop = [int(steps[0, 0])]
    while len(loop) <= len(steps) and (at := following.get(loop[-1], loop[0])) != loop[0]:
        loop.append(at)
    return np.array(loop)


def _regions(count: int, triangles: Indices, rims: list[Indices]) -> Indices:
    """(t,) pieces of triangles that share edges, but none of a rim."""
    edges = edges_of(triangles)
    place = edge_places(count, edges, half_edges_of(triangles))
    steps = np.concatenate([np.stack([rim, np.roll(rim, -1)], axis=1) for rim in rims])
    free = ~np.isin(place, edge_places(count, edges, steps))
    owner = np.repeat(np.arange(len(triangles)), 3)
    links = np.stack([owner[free], len(triangles) + place[free]], axis=1)
    return pieces(links, len(triangles) + len(edges))[1][: len(triangles)]


def _sides(count: int, triangles: Indices, region: Indices, rim: Indices) -> tuple[int, int]:
    """The regions below and above a loop: triangles above have its steps as sides, those below their opposites."""
    half = half_edges_of(triangles)
    known, ends = half[:, 0] * count + half[:, 1], (rim[0], rim[1])
    places = [int(np.flatnonzero(known == a * count + b)[0]) for a, b in (ends[::-1], ends)]
    return int(region[places[0] // 3]), int(region[places[1] // 3])
