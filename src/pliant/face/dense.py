"""A dense face: the mean face subdivided, and moved as the landmarks tell.

The difference of a face from the mean is a Gaussian process of displacements, observed at the landmarks; its mean is
what moves all other vertices. So the vertices between landmarks lie where a smooth face has them.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.face.expressions import expression
from pliant.face.face import Face, dressed
from pliant.face.grouping import groups_of_faces
from pliant.face.handles import FaceHandles
from pliant.face.subdivision import Subdivision
from pliant.face.topology import mean_face
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.ragged import Ragged
from pliant.shape.gaussian_process import GaussianProcess
from pliant.shape.kernels import GaussianKernel, Kernel

Floats = NDArray[np.float64]

BROAD = 3.0, 0.6  # centimetres: how far displacements are alike, and how large they are
FINE = 0.9, 0.25  # the same for what is left
NOISE = 0.02  # centimetres: of a landmark
MOST_LEVELS = 4


def dense_face(face: Face, levels: int = 2) -> Face:
    """A face with more vertices: 6,990 with two levels.

    Parameters
    ----------
    face
        A face from a photograph.
    levels
        How often each triangle of the mean face is cut into four, 1 to 4.

    Raises
    ------
    InvalidParameter
        Another number of levels.
    """
    if not 1 <= levels <= MOST_LEVELS:
        raise InvalidParameter(f"a face is subdivided 1 to {MOST_LEVELS} times; given: {levels}")
    fine = subdivided_mean(levels)
    points = fine.points + difference(face.landmarks, levels)
    groups = groups_of_faces(mean_face().points, fine)
    return face.with_mesh(dressed(points, fine, face.picture, face.pose, groups))


@cache
def subdivided_mean(levels: int) -> PolygonMesh:
    """The mean face after Loop's subdivision; the landmarks are its first 468 vertices."""
    finer = _subdivision(levels)
    return PolygonMesh(finer.weights @ mean_face().points, Ragged.of(finer.triangles))


def difference(landmarks: Points, levels: int, seen: NDArray[np.intp] | None = None) -> Points:
    """(m, 3) what is to be added to the subdivided mean face, after (468, 3) landmarks or those that are seen."""
    chosen = np.arange(len(landmarks)) if seen is None else seen
    places = _subdivision(levels).weights @ _parted()
    moves = landmarks[chosen] - subdivided_mean(levels).points[chosen]
    process = GaussianProcess(_kernel()).posterior(places[chosen], moves, noise=NOISE)
    return process.mean(places)


def _kernel() -> Kernel:
    return GaussianKernel(sigma=BROAD[0], scale=BROAD[1]) + GaussianKernel(sigma=FINE[0], scale=FINE[1])


@cache
def _subdivision(levels: int) -> Subdivision:
    mesh = mean_face()
    return Subdivision.of(mesh.triangles, len(mesh.points), levels)


@cache
def _parted() -> Points:
    """(468, 3) the mean face with mouth and eyes wide open: there, what is close on the face is close in space."""
    points = mean_face().points
    handles = FaceHandles(points)
    return handles.moved(handles.rest + expression("open mouth") - expression("closed eyes"))(points)
