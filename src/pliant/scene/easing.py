"""Easings: how a value goes from one key to the next, as a function of the part of the way in time.

A name, or (x1, y1, x2, y2): the cubic Bézier curve from (0, 0) to (1, 1) with these two handles, time along x.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from pliant.errors import InvalidParameter

Easing = str | tuple[float, float, float, float]

CURVES: dict[str, tuple[float, float, float, float]] = {
    "ease": (0.25, 0.1, 0.25, 1.0),
    "ease_in": (0.42, 0.0, 1.0, 1.0),
    "ease_out": (0.0, 0.0, 0.58, 1.0),
    "ease_in_out": (0.42, 0.0, 0.58, 1.0),
    "overshoot": (0.34, 1.56, 0.64, 1.0),
    "anticipate": (0.36, 0.0, 0.66, -0.56),
}
NAMES = ("step", "linear", "cubic", "smooth", *CURVES, "bounce", "elastic")
"""``"cubic"`` is a curve through the keys around, which the track draws; the others know their two keys only."""

_BOUNCES = ((1 / 2.75, 0.0, 0.0), (2 / 2.75, 1.5 / 2.75, 0.75), (2.5 / 2.75, 2.25 / 2.75, 0.9375))
_LAST = (2.625 / 2.75, 0.984375)


def checked_easing(easing: Easing | Sequence[float]) -> Easing:
    """An easing, if it is one.

    Raises
    ------
    InvalidParameter
        An unknown name, or handles whose curve would go back in time.
    """
    if isinstance(easing, str):
        if easing not in NAMES:
            raise InvalidParameter(f"there is no easing {easing!r}; there are: {', '.join(NAMES)}, or (x1, y1, x2, y2)")
        return easing
    try:
        x1, y1, x2, y2 = map(float, easing)
    except (TypeError, ValueError) as error:
        raise InvalidParameter(f"{easing!r} is no easing: pass a name, or four numbers (x1, y1, x2, y2)") from error
    if not all(map(math.isfinite, (x1, y1, x2, y2))) or not (0 <= x1 <= 1 and 0 <= x2 <= 1):
        raise InvalidParameter(f"the handles {(x1, y1, x2, y2)} are refused: x1 and x2 are times between 0 and 1")
    return x1, y1, x2, y2


def eased(easing: Easing, part: float) -> float:
    """The part of the way in value at a part of the way in time, both 0 at the one key and 1 at the next."""
    if not isinstance(easing, str):
        return _bezier(easing, part)
    if easing in CURVES:
        return _bezier(CURVES[easing], part)
    if easing == "step":
        return 1.0 if part >= 1 else 0.0
    if easing == "smooth":
        return part * part * (3 - 2 * part)
    if easing == "bounce":
        return _bounce(part)
    if easing == "elastic":
        ends = part in (0.0, 1.0)
        return part if ends else 1 + 2.0 ** (-10 * part) * math.sin((10 * part - 0.75) * 2 * math.pi / 3)
    return part


def _bezier(handles: tuple[float, float, float, float], part: float) -> float:
    """The curve's height where its time is ``part``: time grows along the curve, so that bisection finds it."""
    x1, y1, x2, y2 = handles
    low, high = 0.0, 1.0
    if part <= 0 or part >= 1:
        return min(max(part, 0.0), 1.0)
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if _cubic(x1, x2, middle) < part else (low, middle)
    return _cubic(y1, y2, (low + high) / 2)


def _cubic(first: float, second: float, s: float) -> float:
    return 3 * (1 - s) ** 2 * s * first + 3 * (1 - s) * s**2 * second + s**3


def _bounce(part: float) -> float:
    for end, middle, lift in _BOUNCES:
        if part < end:
            return 7.5625 * (part - middle) ** 2 + lift
    return 7.5625 * (part - _LAST[0]) ** 2 + _LAST[1]
