"""How far points have turned about an axis: the twist of the rotation that fits them best, and its derivative.

A rotation is a turn about a given axis, the twist, after which the shortest one follows that takes the axis where it
goes, the swing. With (w, v) the rotation's quaternion and n the axis, the twist is by 2 atan2(v · n, w): zero for a
translation and for whatever swings the axis alone.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.rigid.quaternions import quaternion_of

Floats = NDArray[np.float64]

_ON_A_LINE = 1e-9  # points are, whose second extent is this part of the first: they tell of no turn about it


def twist_about(before: Floats, after: Floats, axis: Floats) -> tuple[float, Floats]:
    """The angle in radians, from -π to π, by which points have turned about an axis; and its gradient.

    Parameters
    ----------
    before, after
        (k, 3) the points.
    axis
        (3,) a unit vector.

    Returns
    -------
    float
        The angle; zero where the points are on a line.
    ndarray
        (k, 3) its derivative by ``after``.
    """
    start, end = before - before.mean(axis=0), after - after.mean(axis=0)
    left, sizes, right = np.linalg.svd(end.T @ start)
    if not sizes[1] > _ON_A_LINE * sizes[0]:
        return 0.0, np.zeros_like(after)
    left[:, 2] *= np.sign(np.linalg.det(left) * np.linalg.det(right))  # a rotation, not a reflection
    rotation = left @ right
    _, vector = quaternion_of(rotation)
    scalar, along = np.sqrt(max(0.0, 1.0 - float(vector @ vector))), float(vector @ axis)
    square = scalar**2 + along**2
    if not square > 0.0:
        return 0.0, np.zeros_like(after)
    by_turn = (scalar**2 * axis + scalar * np.cross(vector, axis) + along * vector) / square
    turned = start @ rotation.T
    stiffness = np.sum(turned * end) * np.eye(3) - turned.T @ end
    gradient = np.cross(np.linalg.pinv(stiffness, rcond=_ON_A_LINE).T @ by_turn, turned)
    return float(2 * np.arctan2(along, scalar)), gradient - gradient.mean(axis=0)
