"""From a photograph's pixels to a face that looks at the viewer, in centimetres."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.face.topology import mean_face
from pliant.mesh import Points
from pliant.shape.procrustes import align, moved

Floats = NDArray[np.float64]

# Landmarks that expressions hardly move: the forehead, the corners of the eyes, the bridge of the nose, the temples.
STABLE = (10, 151, 9, 8, 168, 6, 197, 195, 109, 338, 67, 297, 69, 299, 33, 133, 362, 263, 127, 356, 234, 454)


def pose_of(landmarks: Points) -> Floats:
    """(4, 4) the similarity that brings landmarks in pixels nearest to the mean face.

    Parameters
    ----------
    landmarks
        (468, 3) x to the right, y down, z away from the viewer.
    """
    chosen = list(STABLE)
    turned = landmarks[chosen] * [1.0, -1.0, -1.0]
    return np.asarray(align(turned, mean_face().points[chosen], scale=True) @ np.diag([1.0, -1.0, -1.0, 1.0]))


def to_face(pose: Floats, landmarks: Points) -> Points:
    """(n, 3) positions in the frame of the mean face of places in the photograph."""
    return moved(pose, landmarks)


def to_photograph(pose: Floats, points: Points) -> Points:
    """(n, 3) places in the photograph, in pixels, of positions in the frame of the mean face."""
    return moved(np.asarray(np.linalg.inv(pose), np.float64), points)
