"""Cutting a mesh by planes: the loop where a plane passes through one limb, and the regions between such loops."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter, InvalidTarget
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.meshes.manifold import pieces

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_SAME = 0.25  # of a piece's reach: middles that are no farther apart count as one place


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
    """The piece of a plane's section whose middle is nearest to the plane's origin; of nested ones, the outermost.

    Raises
    ------
    InvalidParameter
        The plane misses the mesh.
    """
    height = (mesh.points - cut.origin) @ cut.normal
    above = height >= 0
    crossing = np.flatnonzero(above[edges[:, 0]] != above[edges[:, 1]])
    if not len(crossing):
        raise InvalidParameter(f"cut {number} misses the mesh: move its origin into the limb that it shall cut")
    a, b = edges[crossing].T
    part = height[a] / (height[a] - height[b])
    points = mesh.points[a] + part[:, None] * (mesh.points[b] - mesh.points[a])
    count, piece = pieces(_neighbours(mesh, edges, crossing), len(crossing))
    sums = np.stack([np.bincount(piece, points[:, i], count) for i in range(3)], axis=1)
    centers = sums / np.bincount(piece, minlength=count)[:, None]
    reach = np.zeros(count)
    np.maximum.at(reach, piece, np.linalg.norm(points - centers[piece], axis=1))
    distance = np.linalg.norm(centers - cut.origin, axis=1)
    near = distance <= distance.min() + _SAME * reach
    chosen = piece == np.where(near, reach, -1.0).argmax()  # of nested ones, the outer
    return Loop(points[chosen], crossing[chosen])


def triangle_edges(mesh: PolygonMesh) -> Indices:
    """(e, 2) the edges of the mesh's triangles, each once."""
    triangles = mesh.triangles.astype(np.int64)
    half = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    return np.asarray(np.unique(np.sort(half, axis=1), axis=0))


def regions(mesh: PolygonMesh, edges: Indices, loops: list[Loop], cuts: tuple[Cut, ...]) -> tuple[Indices, Indices]:
    """What loops cut a mesh into.

    Returns
    -------
    labels
        (n,) the region of each vertex; -1 for vertices without faces.
    sides
        (c, 2) for each cut the region below and above its plane.

    Raises
    ------
    InvalidParameter
        A cut that does not separate two regions.
    InvalidTarget
        A piece of the mesh that no cut passes through.
    """
    kept = np.ones(len(edges), bool)
    for loop in loops:
        kept[loop.edges] = False
    _, labels = pieces(edges[kept], len(mesh.points))
    unused = np.ones(len(mesh.points), bool)
    unused[edges] = False
    labels[unused] = -1
    sides = np.empty((len(cuts), 2), np.int64)
    for number, (loop, cut) in enumerate(zip(loops, cuts, strict=True)):
        ends = edges[loop.edges]
        above = (mesh.points[ends] - cut.origin) @ cut.normal >= 0
        sides[number] = [np.bincount(labels[ends[above == up]]).argmax() for up in (False, True)]
        if sides[number, 0] == sides[number, 1]:
            raise InvalidParameter(f"cut {number} separates nothing: a handle needs two cuts, or one more elsewhere")
    missed = np.setdiff1d(labels[labels >= 0], sides)
    if len(missed):
        first = int(np.flatnonzero(labels == missed[0])[0])
        raise InvalidTarget(
            f"{len(missed)} pieces of the mesh are cut by no plane, the first holds vertex {first}: cut them too, or "
            "leave them out"
        )
    return labels, sides


def _neighbours(mesh: PolygonMesh, edges: Indices, crossing: Indices) -> Indices:
    """(k, 2) pairs of crossing edges that share a triangle."""
    place = np.full(len(edges), -1)
    place[crossing] = np.arange(len(crossing))
    triangles = mesh.triangles.astype(np.int64)
    half = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    count = len(mesh.points)
    found = np.searchsorted(edges[:, 0] * count + edges[:, 1], half[:, 0] * count + half[:, 1])
    sides = place[found].reshape(-1, 3)
    pairs = np.concatenate([sides[:, [0, 1]], sides[:, [1, 2]], sides[:, [2, 0]]])
    return pairs[(pairs >= 0).all(axis=1)]
