"""Placements between placements: what lies between two affine maps when one tool or object moves to the other.

The linear part is taken apart into a rotation and a stretch; the rotation turns about one axis at a constant rate,
stretch and position change in proportion (Shoemake & Duff 1992).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.rotations import nearest_rotations, rotations_of

Floats = NDArray[np.float64]


def between(first: Floats, second: Floats, part: float) -> Floats:
    """(4, 4) the map at a part of the way from one (4, 4) affine map to another; beyond 0 and 1 it goes on."""
    turns = nearest_rotations(np.stack([first[:3, :3], second[:3, :3]]))
    stretches = turns.transpose(0, 2, 1) @ np.stack([first[:3, :3], second[:3, :3]])
    turn = turns[0] @ rotations_of(part * _vector(turns[0].T @ turns[1])[None])[0]
    result = np.eye(4)
    result[:3, :3] = turn @ ((1 - part) * stretches[0] + part * stretches[1])
    result[:3, 3] = (1 - part) * first[:3, 3] + part * second[:3, 3]
    return result


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
