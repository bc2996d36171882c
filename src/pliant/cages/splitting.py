"""Triangles split where planes pass through them, so that loops become edges and what lies between them regions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.cages.sections import Cut, Loop, edge_places, edges_of, half_edges_of
from pliant.mesh import Points
from pliant.numerics.meshes.manifold import pieces

Indices = NDArray[np.int64]

_OFF = 1e-4  # of an edge: how near to its ends it is split at the most


@dataclass(frozen=True)
class Split:
    """A surface and the loops along which it has been split.

    Parameters
    ----------
    points, triangles
        The surface.
    rims
        For each loop its vertices in order, counter-clockwise about its plane's normal.
    """

    points: Points
    triangles: Indices
    rims: tuple[Indices, ...] = ()


def loops_apart(found: Split, edges: Indices, loop: Loop) -> bool:
    """Whether a loop crosses none of those that are there."""
    for rim in found.rims:
        steps = np.stack([rim, np.roll(rim, -1)], axis=1)
        if np.isin(edge_places(len(found.points), edges, steps), loop.edges).any():
            return False
    return True


def split(found: Split, edges: Indices, loop: Loop, cut: Cut) -> Split | None:
    """The surface with one more loop as edges; None where that passes through what is no manifold.

    Parameters
    ----------
    found, edges
        The surface, and (e, 2) its edges.
    loop, cut
        Which of them are cut, and the plane that does.
    """
    points, triangles = found.points, found.triangles
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
        return None
    return Split(points, np.concatenate([triangles[~through], *pieces_of]), (*found.rims, rim))


def traced(steps: Indices) -> Indices:
    """The loop that (k, 2) directed steps make from the first one on; shorter, where they make no single loop."""
    following = dict(steps.tolist())
    loop = [int(steps[0, 0])]
    while len(loop) <= len(steps) and (at := following.get(loop[-1], loop[0])) != loop[0]:
        loop.append(at)
    return np.array(loop)


def regions_between(found: Split) -> Indices:
    """(t,) pieces of triangles that share edges, but none of a rim."""
    count, triangles = len(found.points), found.triangles
    edges = edges_of(triangles)
    place = edge_places(count, edges, half_edges_of(triangles))
    steps = np.concatenate([np.empty((0, 2), np.int64), *(np.stack([r, np.roll(r, -1)], axis=1) for r in found.rims)])
    free = ~np.isin(place, edge_places(count, edges, steps))
    owner = np.repeat(np.arange(len(triangles)), 3)
    links = np.stack([owner[free], len(triangles) + place[free]], axis=1)
    return pieces(links, len(triangles) + len(edges))[1][: len(triangles)]


def beside(found: Split, region: Indices, rim: Indices) -> tuple[int, int]:
    """The regions below and above a loop: triangles above have its steps as sides, those below their opposites."""
    half, count = half_edges_of(found.triangles), len(found.points)
    known, ends = half[:, 0] * count + half[:, 1], (rim[0], rim[1])
    places = [int(np.flatnonzero(known == a * count + b)[0]) for a, b in (ends[::-1], ends)]
    return int(region[places[0] // 3]), int(region[places[1] // 3])
