"""Orientations as files keep them: a unit quaternion and a handedness, as in the qform of NIfTI-1.

Only three numbers (b, c, d) of the quaternion are stored; the first follows from them and is not negative. A
left-handed frame is a rotation whose third axis is turned round (``qfac`` = -1).
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_HALF_TURN = 1e-7  # below this a^2 is rounding: the turn is of 180 degrees, and (b, c, d) is normalised (nifti1_io)


def axes_of(qfac: float, bcd: Floats) -> Floats:
    """(3, 3) orthonormal matrix whose columns are the axes (nifti1.h, method 2).

    Parameters
    ----------
    qfac
        Negative for a left-handed frame.
    bcd
        (3,) the quaternion without its first number.
    """
    square = 1.0 - float(bcd @ bcd)
    if square < _HALF_TURN:
        a, (b, c, d) = 0.0, bcd / np.linalg.norm(bcd)
    else:
        a, (b, c, d) = np.sqrt(square), bcd
    axes = np.array(
        [
            [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c],
        ]
    )
    if qfac < 0:
        axes[:, 2] *= -1.0
    return axes + 0.0  # no negative zeros


def quaternion_of(axes: Floats) -> tuple[float, Floats]:
    """The handedness and (b, c, d) of a (3, 3) orthonormal matrix whose columns are axes.

    The outer product of the quaternion with itself is linear in the matrix; its row with the largest diagonal
    entry is the quaternion, up to length.
    """
    qfac = 1.0 if np.linalg.det(axes) > 0 else -1.0
    r = axes * [1.0, 1.0, qfac]
    x, y, z = r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
    xy, xz, yz = r[0, 1] + r[1, 0], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1]
    outer = np.array(
        [
            [1 + r[0, 0] + r[1, 1] + r[2, 2], x, y, z],
            [x, 1 + r[0, 0] - r[1, 1] - r[2, 2], xy, xz],
            [y, xy, 1 - r[0, 0] + r[1, 1] - r[2, 2], yz],
            [z, xz, yz, 1 - r[0, 0] - r[1, 1] + r[2, 2]],
        ]
    )
    quaternion = outer[np.argmax(np.diag(outer))]
    quaternion = quaternion / np.linalg.norm(quaternion)
    return qfac, (-quaternion if quaternion[0] < 0 else quaternion)[1:] + 0.0


def rounded_quaternion(axes: Floats, decimals: int) -> tuple[float, Floats]:
    """The handedness and the (b, c, d) of so many decimals that come nearest to a (3, 3) matrix of axes.

    Rounding each number to the nearest is not the best: near a half turn an error of 5e-7 in b, c, d becomes one
    of 1e-3 in a. The neighbours are tried, farther ones where near ones leave more than a few of the last digits.
    """
    qfac, exact = quaternion_of(axes)
    middle, unit = np.round(exact, decimals), 10.0**-decimals
    for reach in (1, 3, 6):
        steps = np.array(list(product(range(-reach, reach + 1), repeat=3))) * unit
        candidates = np.round(middle + steps, decimals) + 0.0
        errors = [np.abs(axes_of(qfac, bcd) - axes).max() for bcd in candidates]
        best = int(np.argmin(errors))
        if errors[best] <= 8 * unit:
            break
    return qfac, candidates[best]
