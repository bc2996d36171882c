"""Where faces are in a photograph, roughly: a box and two eyes each.

The detectors answer for each of a grid of anchors how likely a face is there, how far its box and its eyes are from the
anchor (Bazarevsky et al. 2019, "BlazeFace"). One sees faces that fill the picture, the other smaller ones; for still
smaller ones it is shown the picture in overlapping pieces.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pliant.face.networks import FAR, NEAR, network
from pliant.face.windows import Window

if TYPE_CHECKING:
    from PIL.Image import Image

Floats = NDArray[np.float64]

LIKELY = 0.5  # probability from which an answer counts
SAME = 0.3  # boxes that share this part of their union show one face
PIECE = 0.5  # of the shorter side of the photograph
ENLARGED = 1.5  # window of the landmarks, against the detector's box
CELLS = {NEAR: ((16, 2), (8, 6)), FAR: ((48, 1),)}  # cells a side of each grid of anchors, and anchors a cell


@dataclass(frozen=True)
class Detection:
    """A face: how likely, and the window in which its landmarks are looked for."""

    likely: float
    window: Window


def detect(image: Image, angle: float = 0.0) -> list[Detection]:
    """Faces in a photograph that is turned by an angle (a multiple of a right angle), the likeliest first."""
    whole = Window.around(image, angle)
    found = [each for name in (NEAR, FAR) for each in _seen_by(name, image, whole)]
    for piece in _pieces(image, angle):
        found += _seen_by(FAR, image, piece)
    return _distinct(found)


def _pieces(image: Image, angle: float) -> list[Window]:
    """Squares that overlap by half and cover the photograph."""
    side = PIECE * min(image.size)
    middles = [np.linspace(side / 2, extent - side / 2, int(np.ceil(2 * extent / side)) - 1) for extent in image.size]
    return [Window(float(x), float(y), side, angle) for y in middles[1] for x in middles[0]]


def _seen_by(name: str, image: Image, window: Window) -> list[Detection]:
    look = network(name)
    boxes, scores = look(2 * window.seen(image, look.size) - 1)
    likely = 1 / (1 + np.exp(-np.clip(scores.astype(np.float64), -60, 60)))
    chosen = np.flatnonzero(likely >= LIKELY)
    answers = boxes.reshape(-1, 8, 2)[chosen].astype(np.float64) / look.size
    anchors = _anchors(name)[chosen]
    return [
        Detection(float(likely[at]), _window(answer, anchor, window))
        for at, answer, anchor in zip(chosen, answers, anchors, strict=True)
    ]


def _window(answer: Floats, anchor: Floats, window: Window) -> Window:
    """The window of a face from one answer: (8, 2) with the box's middle, its size, and points, the eyes first."""
    middle, right_eye, left_eye = window.outside(anchor + answer[[0, 2, 3]])
    along = left_eye - right_eye
    side = ENLARGED * window.side * float(answer[1].max())
    return Window(float(middle[0]), float(middle[1]), side, float(np.arctan2(along[1], along[0])))


def _anchors(name: str) -> Floats:
    """(a, 2) the middles of the cells, row by row, between 0 and 1."""
    grids = []
    for cells, each in CELLS[name]:
        y, x = np.divmod(np.arange(cells * cells), cells)
        grids.append(np.repeat((np.stack([x, y], axis=1) + 0.5) / cells, each, axis=0))
    return np.concatenate(grids)


def _distinct(found: list[Detection]) -> list[Detection]:
    """The likeliest of each face."""
    kept: list[Detection] = []
    for each in sorted(found, key=lambda detection: -detection.likely):
        if all(overlap(each.window, other.window) < SAME for other in kept):
            kept.append(each)
    return kept


def overlap(one: Window, two: Window) -> float:
    """The part of the union of two squares that is in both, as if they were upright."""
    low = np.maximum([one.x - one.side / 2, one.y - one.side / 2], [two.x - two.side / 2, two.y - two.side / 2])
    high = np.minimum([one.x + one.side / 2, one.y + one.side / 2], [two.x + two.side / 2, two.y + two.side / 2])
    shared = float(np.prod(np.maximum(high - low, 0)))
    return shared / (one.side**2 + two.side**2 - shared)
