"""MIRTK's rigid, similarity and affine parameters: T R H S, of translation, rotation, shears and scales.

Lengths in millimetres, angles in degrees, scales in percent; R is the transpose of Rz Ry Rx, H has the tangents of
the shear angles xy, yz, xz above its diagonal.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.space.affine import Affine

Floats = NDArray[np.float64]

COUNTS = {"rigid": (6,), "similarity": (7,), "affine": (9, 12, 15)}
"""How many parameters the kinds have."""


def matrix_of(parameters: Floats) -> Floats:
    """(4, 4) from 6, 7, 9, 12 or 15 parameters."""
    count = len(parameters)
    rx, ry, rz = np.radians(parameters[3:6])
    turns = [Affine.rotation(axis, float(angle)).linear for axis, angle in zip("zyx", (rz, ry, rx), strict=True)]
    scales = np.full(3, 100.0)
    if count == 7:
        scales = np.repeat(parameters[6], 3)
    elif count >= 9:
        scales = parameters[6:9]
    shear = np.eye(3)
    if count >= 12:
        shear[0, 1], shear[1, 2], shear[0, 2] = np.tan(np.radians(parameters[9:12]))
    matrix = np.eye(4)
    matrix[:3, :3] = (turns[0] @ turns[1] @ turns[2]).T @ shear * (scales / 100)
    matrix[:3, 3] = parameters[:3]
    return matrix


def parameters_of(matrix: Floats) -> Floats:
    """(12,) parameters of a regular (4, 4) matrix, by QR decomposition: the scales are positive but for a mirror's."""
    rotation, upper = np.linalg.qr(matrix[:3, :3])
    signs = np.where(np.diag(upper) < 0, -1.0, 1.0)
    rotation, upper = rotation * signs, signs[:, None] * upper
    scales = np.diag(upper).copy()
    if np.linalg.det(rotation) < 0:  # a mirror: the last axis is turned round in the rotation and in its scale
        rotation[:, 2] *= -1
        upper[2] *= -1
        scales = np.diag(upper).copy()
    shear = upper / scales
    ry = -np.arcsin(np.clip(rotation[0, 2], -1, 1))
    if np.hypot(rotation[0, 0], rotation[0, 1]) > 1e-9:
        rx = np.arctan2(rotation[1, 2], rotation[2, 2])
        rz = np.arctan2(rotation[0, 1], rotation[0, 0])
    else:  # x and z turn about the same axis: all of it is given to z
        rx, rz = 0.0, np.arctan2(-rotation[1, 0], rotation[1, 1])
    angles = np.degrees([rx, ry, rz, *np.arctan([shear[0, 1], shear[1, 2], shear[0, 2]])])
    return np.concatenate([matrix[:3, 3], angles[:3], 100 * scales, angles[3:]])
