"""Clamped uniform B-splines of order up to four as cubic Bézier pieces, and the way back from even spacing.

A curve with n control values has degree d = min(3, n - 1) and n - d spans of equal length; it begins and ends at its
outermost control values. Evenly spaced control values make no even parameter: :func:`parameters` solves for it.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from pliant.numerics.lattices.bases import bernstein

Floats = NDArray[np.float64]

_PLACES = np.array([1.0, 3, 5, 7]) / 8  # in a span, where both forms are compared


def spans(count: int) -> int:
    """How many pieces the curve of so many control values has."""
    return count - min(3, count - 1)


@cache
def pieces(count: int) -> Floats:
    """(3 spans + 1, count) cubic Bézier values of the pieces, from control values; read-only."""
    degree, number = min(3, count - 1), spans(count)
    knots = np.concatenate([np.zeros(degree), np.arange(number + 1.0), np.full(degree, float(number))])
    curves = BSpline(knots, np.eye(count), degree)
    to_bezier = np.linalg.inv(bernstein(3, _PLACES))
    matrix = np.zeros((3 * number + 1, count))
    for span in range(number):
        matrix[3 * span : 3 * span + 4] = to_bezier @ curves(span + _PLACES)
    matrix[np.abs(matrix) < 1e-15] = 0.0
    matrix.flags.writeable = False
    return matrix


def parameters(count: int, t: Floats) -> tuple[Floats, Floats]:
    """Where the curve of evenly spaced control values from 0 to 1 has the values t, and dt/ds there.

    Newton's method in each piece; the curve rises monotonically. Beyond [0, 1] it goes on straight.

    Returns
    -------
    s, slope
        Shaped as ``t``; s is counted in spans.
    """
    if count == 1:
        return t.copy(), np.ones_like(t)
    values, number = pieces(count) @ np.linspace(0, 1, count), spans(count)
    inside = np.clip(t, 0.0, 1.0)
    span = np.clip(np.searchsorted(values[::3], inside, side="right") - 1, 0, number - 1)
    a, b, c, d = (values[3 * span + i] for i in range(4))
    u = np.clip((inside - a) / (d - a), 0.0, 1.0)
    for _ in range(30):
        step = (_value(a, b, c, d, u) - inside) / _slope(a, b, c, d, u)
        u = np.clip(u - step, 0.0, 1.0)
        if not step.size or np.abs(step).max() < 1e-15:
            break
    slope = _slope(a, b, c, d, u)
    return span + u + (t - inside) / slope, slope


def _value(a: Floats, b: Floats, c: Floats, d: Floats, u: Floats) -> Floats:
    v = 1 - u
    return ((a * v + 3 * b * u) * v + 3 * c * u * u) * v + d * u**3


def _slope(a: Floats, b: Floats, c: Floats, d: Floats, u: Floats) -> Floats:
    v = 1 - u
    return 3 * ((b - a) * v * v + 2 * (c - b) * u * v + (d - c) * u * u)
