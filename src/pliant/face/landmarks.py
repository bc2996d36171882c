"""The 468 landmarks of faces in a photograph (Kartynnik et al. 2019, "Real-time facial surface geometry")."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pliant.errors import PliantError
from pliant.face.detector import SAME, Detection, detect, overlap
from pliant.face.networks import LANDMARKS, network
from pliant.face.windows import Window

if TYPE_CHECKING:
    from PIL.Image import Image

Floats = NDArray[np.float64]

COUNT = 468
RIGHT_EYE, LEFT_EYE = 33, 263  # outer corners
PASSES = 2  # the second sees the face in the middle of its window, and upright
FILLED = 1.5  # window against the landmarks in it
CERTAIN = 15.0  # score from which there is a face; upside down one gets about 12, and what is none less than 8
SURE = 25.0  # score from which no other orientation is tried


class NoFace(PliantError):
    """A photograph in which no face is found, or not as many as asked for."""


@dataclass(frozen=True, eq=False)
class FaceLandmarks:
    """One face.

    Parameters
    ----------
    points
        (468, 3) x to the right, y down, z away from the viewer, all in pixels of the photograph. Depth is relative.
    score
        How certain the network is: the logit of its probability.
    """

    points: Floats
    score: float

    @property
    def width(self) -> float:
        """How many pixels the face is wide, or high if that is more."""
        return float(np.ptp(self.points[:, :2], axis=0).max())

    @property
    def window(self) -> Window:
        """The window around the face, turned as its eyes are."""
        return _around(self.points)


def find_landmarks(image: Image) -> list[FaceLandmarks]:
    """All faces, the largest first.

    A photograph in which none is surely there is looked at again on its sides and upside down.

    Raises
    ------
    NoFace
        None is found at all.
    MissingExtra
        The networks are not installed.
    """
    faces: list[FaceLandmarks] = []
    for angle in (0.0, pi / 2, -pi / 2, pi):
        faces = _distinct([*faces, *(_landmarks(image, each) for each in detect(image, angle))])
        if faces and faces[0].score >= SURE:
            break
    if faces:
        return sorted(faces, key=lambda face: -face.width)
    raise NoFace(
        f"no face is found in the picture of {image.width} × {image.height} pixels, however it is turned: give one in "
        "which a face is seen from the front, lit, and 60 pixels wide or more"
    )


def _landmarks(image: Image, detection: Detection) -> FaceLandmarks:
    look, window = network(LANDMARKS), detection.window
    for _ in range(PASSES):
        answer, score = look(window.seen(image, look.size))
        places = answer.reshape(COUNT, 3).astype(np.float64) / look.size
        points = np.column_stack([window.outside(places[:, :2]), window.side * places[:, 2]])
        window = _around(points)
    return FaceLandmarks(points, float(score[0]))


def _distinct(faces: list[FaceLandmarks]) -> list[FaceLandmarks]:
    """Those that are certain, each once, the most certain first."""
    kept: list[FaceLandmarks] = []
    for face in sorted(faces, key=lambda face: -face.score):
        if face.score >= CERTAIN and all(overlap(face.window, other.window) < SAME for other in kept):
            kept.append(face)
    return kept


def _around(points: Floats) -> Window:
    along = points[LEFT_EYE, :2] - points[RIGHT_EYE, :2]
    angle = float(np.arctan2(along[1], along[0]))
    axes = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    turned = points[:, :2] @ axes.T
    low, high = turned.min(axis=0), turned.max(axis=0)
    x, y = (low + high) / 2 @ axes
    return Window(float(x), float(y), FILLED * float((high - low).max()), angle)
