"""Linking rings along a surface: its vertices gather around the corners of the rings, and what is left is the cage.

Each vertex of a region goes to the nearest of some seeds, along edges (Dijkstra). A triangle whose corners go to three
seeds becomes a face between these: the dual of a Voronoi diagram on the surface. Seeds are the corners of the rings,
and as many places between them as are needed, each the farthest from all others.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.cages.sections import Cut, axes_across, edges_of
from pliant.mesh import Points
from pliant.numerics.meshes.manifold import manifold_faults
from pliant.numerics.ragged import Ragged

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_MOST = 80  # seeds between the rings


@dataclass(frozen=True)
class Clusters:
    """(t, 3) faces; their corners are those of the rings, and behind these (k, 3) places between the rings."""

    faces: Indices
    places: Points


def collar(points: Points, rim: Indices, cut: Cut, sides: int, first: int) -> Indices:
    """(k, 3) triangles between a loop and the ring around it, as they go on from the region above.

    The ring's side i touches the loop where it goes farthest; from there to where side i + 1 does, the loop belongs to
    corner i.

    Parameters
    ----------
    points, rim, cut
        The loop: vertices in order, counter-clockwise about the plane's normal.
    sides, first
        How many corners the ring has, and the index of the first one.
    """
    u, v = axes_across(cut.normal)
    flat = np.stack([points[rim] @ u, points[rim] @ v], axis=1)
    angles = 2 * np.pi * np.arange(sides) / sides
    touch = (flat @ np.stack([np.cos(angles), np.sin(angles)])).argmax(axis=0)
    count = len(rim)
    start = touch[0]
    steps = np.maximum.accumulate((touch - start) % count)
    corner = np.searchsorted(steps, np.arange(count), side="right") - 1
    here, there = np.roll(rim, -start), np.roll(rim, -start - 1)
    strip = np.column_stack([there, here, first + corner])
    before = (np.arange(sides) - 1) % sides
    fans = np.column_stack([here[steps], first + before, first + np.arange(sides)])
    return np.concatenate([strip, fans])


def clustered(
    points: Points, triangles: Indices, rings: Indices, near: Points, wanted: int, room: float, border: Indices
) -> Clusters | None:
    """The faces between rings, along a surface.

    Parameters
    ----------
    points, triangles
        The surface, collars and rings included.
    rings
        Indices of all corners.
    near
        (k, 3) where on the surface there shall be places.
    wanted
        The least number of places between the rings.
    room
        How far places are moved off the surface.
    border
        (e, 2) the open edges that the faces shall have, in seeds: their places in ``rings``.

    Returns
    -------
    Clusters, or None where no number of seeds gives a surface.
    """
    from scipy.spatial import KDTree

    used, local = np.unique(triangles, return_inverse=True)
    local, places = local.reshape(-1, 3), points[used]
    graph = _graph(places, local)
    seeds = np.searchsorted(used, rings)
    if len(near):
        found = KDTree(places).query(near)[1]
        seeds = np.concatenate([seeds, np.setdiff1d(found, seeds)])
    distance, nearest = _gathered(graph, seeds)
    while len(seeds) - len(rings) <= _MOST:
        among = np.isfinite(distance)
        if len(seeds) - len(rings) >= wanted:
            label = np.full(len(used), -1)
            label[seeds] = np.arange(len(seeds))
            faces = _quotient(label[nearest][local])
            wrong = _unsound(faces, len(seeds), border)
            if not len(wrong):
                return Clusters(faces, _lifted(places, local, nearest, seeds[len(rings) :], room))
            among &= np.isin(nearest, seeds[wrong])
        seeds = np.append(seeds, np.where(among, distance, -1.0).argmax())
        distance, nearest = _gathered(graph, seeds)
    return None


def _graph(points: Points, triangles: Indices) -> object:
    from scipy.sparse import coo_array

    edges = edges_of(triangles)
    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    lengths = np.maximum(lengths, 1e-12 * lengths.max())  # a zero would be no edge at all
    return coo_array((lengths, edges.T), shape=(len(points), len(points))).tocsr()


def _gathered(graph: object, seeds: Indices) -> tuple[Floats, Indices]:
    """How far each vertex is from the nearest seed, and which that is."""
    from scipy.sparse.csgraph import dijkstra

    distance, _, nearest = dijkstra(
        graph, directed=False, indices=np.sort(seeds), min_only=True, return_predecessors=True
    )
    return distance, nearest.astype(np.int64)


def _quotient(labels: Indices) -> Indices:
    """(t, 3) the triangles between three different seeds, those that lie on one another in pairs left out."""
    faces = labels[(labels[:, 0] != labels[:, 1]) & (labels[:, 1] != labels[:, 2]) & (labels[:, 2] != labels[:, 0])]
    turn = (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3
    faces = np.take_along_axis(faces, turn, 1)
    odd = faces[:, 1] > faces[:, 2]
    sorted_faces = np.where(odd[:, None], faces[:, [0, 2, 1]], faces)
    kinds, inverse = np.unique(sorted_faces, axis=0, return_inverse=True)
    net = np.bincount(inverse.reshape(-1), np.where(odd, -1.0, 1.0), len(kinds)).astype(int)
    found = np.where((net < 0)[:, None], kinds[:, [0, 2, 1]], kinds)
    return np.repeat(found, np.abs(net), axis=0)


def _unsound(faces: Indices, count: int, border: Indices) -> Indices:
    """The seeds where faces are no manifold, or have open edges that are none of the rings': more are needed there."""
    faults = manifold_faults(Ragged.of(faces), count) if len(faces) else None
    if faults is None:
        return np.arange(count)
    wanted = np.sort(border, axis=1) @ [count, 1]
    odd = np.setxor1d(faults.open @ [count, 1], wanted)
    unused = np.setdiff1d(np.arange(count), faces)
    return np.unique(np.concatenate([faults.wrong.reshape(-1), faults.pinched, odd // count, odd % count, unused]))


def _lifted(points: Points, triangles: Indices, nearest: Indices, seeds: Indices, room: float) -> Points:
    """Seeds moved off the surface, along the mean normal of what gathers around them."""
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.zeros_like(points)
    for k in range(3):
        np.add.at(sums, nearest[triangles[:, k]], normals)
    lengths = np.linalg.norm(sums[seeds], axis=1, keepdims=True)
    return np.asarray(points[seeds] + room * sums[seeds] / np.maximum(lengths, 1e-300))
