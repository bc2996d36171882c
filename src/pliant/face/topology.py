"""The mean face: 468 points, 852 triangles, open eyes and mouth, symmetric about x = 0.

All of it is made by ``tools/mean_face.py`` from what the landmark network answers to plain grey pictures. Centimetres,
of which 14 across a face are assumed; x to the viewer's right, y up, z towards the viewer.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points, PolygonMesh

WIDTH = 14.0  # centimetres between the sides of the mean face
Indices = NDArray[np.int64]


@cache
def mean_face() -> PolygonMesh:
    """The mean face.

    Four loops bound it: the outline of 36 vertices, the lids of either eye, 16 each, and the inner lips, 20.
    """
    with np.load(_FILE) as stored:
        return PolygonMesh(stored["points"], stored["triangles"])


@cache
def opposite() -> Indices:
    """(468,) the landmark on the other side of each; itself in the middle."""
    with np.load(_FILE) as stored:
        return np.asarray(stored["pairs"], np.int64)


def mirrored(points: Points) -> Points:
    """(468, 3) the mirror image of a face: each landmark where the one opposite was."""
    return np.asarray(points[opposite()] * [-1.0, 1.0, 1.0])


@cache
def openings() -> tuple[Indices, ...]:
    """The loops of vertices around the right eye, the left eye and the mouth, each in the direction that fills it."""
    loops = boundary_loops(mean_face().triangles)
    return tuple(next(loop for loop in loops if vertex in loop) for vertex in (33, 263, 13))


def boundary_loops(triangles: NDArray[np.int32]) -> list[Indices]:
    """The loops that bound a manifold, opposite to the direction of its triangles."""
    ends = {(int(a), int(b)) for t in triangles for a, b in zip(t, np.roll(t, -1), strict=True)}
    following = {b: a for a, b in ends if (b, a) not in ends}
    loops = []
    while following:
        start, vertex = following.popitem()
        loop = [start]
        while vertex != start:
            loop.append(vertex)
            vertex = following.pop(vertex)
        loops.append(np.array(loop))
    return loops


_FILE = Path(__file__).with_name("mean_face.npz")
