"""Where to look from, and from how far, so that everything fits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidParameter

Floats = NDArray[np.float64]

ANGLE = np.radians(20.0)  # the vertical view angle: long lens, little distortion
# seen from: to the right, towards the viewer, upwards
VIEWS = {
    "iso": (0.9, 1.25, 0.75),
    "front": (0, 1, 0),
    "back": (0, -1, 0),
    "right": (1, 0, 0),
    "left": (-1, 0, 0),
    "top": (0, 1e-3, 1),
    "bottom": (0, 1e-3, -1),
}
# right, towards the viewer, up
FRAMES = {"z": np.array([[1.0, 0, 0], [0, -1, 0], [0, 0, 1]]), "y": np.array([[1.0, 0, 0], [0, 0, 1], [0, 1, 0]])}


@dataclass(frozen=True, eq=False)
class Camera:
    """A placed camera: positions, the upward direction and the shift of the picture's middle."""

    position: Floats
    focus: Floats
    up: Floats
    shift: float


def view_axes(view: str | ArrayLike, up: str) -> Floats:
    """(3, 3) rows: to the right of the picture, upwards in it, and towards the viewer.

    Raises
    ------
    InvalidParameter
        An unknown view, a direction that is zero, or an axis that is not y or z.
    """
    if up not in FRAMES:
        raise InvalidParameter(f"up is 'y' or 'z'; given: {up!r}")
    if isinstance(view, str):
        if view not in VIEWS:
            raise InvalidParameter(f"no view is called {view!r}; there are: {', '.join(VIEWS)}, or give a direction")
        toward = np.array(VIEWS[view], float) @ FRAMES[up]
    else:
        toward = np.asarray(view, np.float64)
        if toward.shape != (3,) or not np.isfinite(toward).all() or not toward.any():
            raise InvalidParameter(f"a view is a name or a direction (3,) that is not zero; given: {view!r}")
    toward = toward / np.linalg.norm(toward)
    right = np.cross(FRAMES[up][2], toward)
    if np.linalg.norm(right) < 1e-9:
        right = FRAMES[up][0]
    right = right / np.linalg.norm(right)
    return np.stack([right, np.cross(toward, right), toward])


def frame(points: Floats, axes: Floats, aspect: float, *, margin: float = 0.07, right: float = 0.0) -> Camera:
    """The closest camera that sees all points.

    Parameters
    ----------
    points
        (n, 3) what must be in the picture.
    axes
        From :func:`view_axes`.
    aspect
        Width over height of the picture.
    margin
        What is left free on each side, as a part of the picture.
    right
        What more is left free on the right, as a part of the width.
    """
    seen = points @ axes.T
    tall = np.tan(ANGLE / 2) * (1 - 2 * margin)
    wide = np.tan(ANGLE / 2) * aspect * (1 - 2 * margin - right)
    nearest = 1e-9 * float(np.ptp(seen, axis=0).max()) or 4.0  # one point is looked at from anywhere
    middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
    distance = _distance(seen - middle, wide, tall, nearest)
    for _ in range(8):  # the middle of the picture depends on the distance and the other way round; this settles fast
        x, y, depth = (seen - middle).T
        for axis, offset in enumerate((x, y)):
            angle = offset / (distance - np.minimum(depth, 0.999 * distance))
            middle[axis] += distance * (angle.min() + angle.max()) / 4
        distance = _distance(seen - middle, wide, tall, nearest)
    focus = middle @ axes
    return Camera(focus + distance * axes[2], focus, axes[1], right)


def _distance(seen: Floats, wide: float, tall: float, nearest: float) -> float:
    """The least distance from the middle of the picture at which all points are in it."""
    x, y, depth = seen.T
    return float(max((np.abs(x) / wide + depth).max(), (np.abs(y) / tall + depth).max(), nearest))
