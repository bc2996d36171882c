"""Placements between placements: what lies between two affine maps when one tool or object moves to the other.

The way from one to the other is taken as one turn, with stretches in proportion, about the place that it leaves where
it is (Shoemake & Duff 1992 take the linear part apart likewise): a motion does not depend on where the origin lies.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.rigid.rotations import nearest_rotations, rotations_of

Floats = NDArray[np.float64]

_NOTHING = 1e-14  # of a linear part: what rounding leaves
_STILL = 1e-9  # of the largest change: less of one leaves no place where it is


def between(first: Floats, second: Floats, part: float) -> Floats:
    """(4, 4) the map at a part of the way from one (4, 4) affine map to another; beyond 0 and 1 it goes on."""
    way = np.asarray(np.linalg.solve(first, second), np.float64)
    linear, offset = way[:3, :3], way[:3, 3]
    turn = nearest_rotations(linear[None])[0]
    stretch = turn.T @ linear
    partial = rotations_of(part * _vector(turn)[None])[0] @ ((1 - part) * np.eye(3) + part * stretch)
    change = np.eye(3) - linear
    still = np.linalg.pinv(change, rcond=_STILL) @ offset if np.abs(change).max() > _NOTHING else np.zeros(3)
    result = np.eye(4)
    result[:3, :3] = partial
    result[:3, 3] = still - partial @ still + part * (offset - still + linear @ still)
    return np.asarray(first @ result)


def _vector(rotation: Floats) -> Floats:
    """(3,) the rotation vector of a rotation matrix, no longer than a half turn."""
    skew = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]])
    sine, cosine = float(np.linalg.norm(skew)) / 2, (float(np.trace(rotation)) - 1) / 2
    if sine > 1e-9:
        return np.asarray(np.arctan2(sine, cosine) / (2 * sine) * skew)
    if cosine > 0:
        return skew / 2
    axis = np.sqrt(np.maximum(np.diagonal(rotation) + 1, 0.0) / 2)  # a half turn: R = 2 a a^T - 1
    strongest = int(np.argmax(axis))
    axis = axis * np.where(rotation[strongest] < 0, -1.0, 1.0)
    axis[strongest] = abs(axis[strongest])
    return np.asarray(np.pi * axis / np.linalg.norm(axis))
