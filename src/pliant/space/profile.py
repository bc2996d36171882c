"""Profiles: how strongly a deformation acts along its axis, as a function of t, 0 at the low bound, 1 at the high."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidDeformer

Floats = NDArray[np.float64]

NAMED = {
    "ramp": (0.0, 1.0, 0.0, 0.0),
    "constant": (1.0, 0.0, 0.0, 0.0),
    "smooth": (0.0, 0.0, 3.0, -2.0),
    "bump": (0.0, 6.0, -6.0, 0.0),
}
"""Polynomials, lowest power first: straight from 0 to 1; 1; from 0 to 1 with level ends; 0 at both ends, mean 1."""


@dataclass(frozen=True)
class Profile:
    """A profile given by functions of t in [0, 1], arrays in, arrays out.

    Parameters
    ----------
    value
        h(t).
    slope
        h'(t).
    integral
        The integral of h from 0 to t; only :class:`~pliant.space.squash.Squash` needs it.
    """

    value: Callable[[Floats], Any]
    slope: Callable[[Floats], Any]
    integral: Callable[[Floats], Any] | None = None


@dataclass(frozen=True, eq=False)
class Curve:
    """A piecewise cubic profile on [0, 1].

    Parameters
    ----------
    pieces
        (k, 6) where each piece begins and ends, and its coefficients from its beginning on, lowest power first.
    """

    pieces: Floats

    def value(self, t: Floats) -> Floats:
        """h at t in [0, 1]."""
        x, c = self._at(t)
        return np.asarray(((x * c[3] + c[2]) * x + c[1]) * x + c[0])

    def slope(self, t: Floats) -> Floats:
        """The derivative of h."""
        x, c = self._at(t)
        return np.asarray((x * (3 * c[3]) + 2 * c[2]) * x + c[1])

    def integral(self, t: Floats) -> Floats:
        """The integral of h from 0."""
        x, c = self._at(t)
        width = self.pieces[:, 1] - self.pieces[:, 0]
        whole = _area(width, self.pieces[:, 2:].T)
        before = np.concatenate([[0.0], np.cumsum(whole)[:-1]])
        return np.asarray(before[self._piece(t)] + _area(x, c))

    def _piece(self, t: Floats) -> NDArray[np.int64]:
        return np.searchsorted(self.pieces[1:, 0], t, side="right")

    def _at(self, t: Floats) -> tuple[Floats, Floats]:
        """The distance from the piece's beginning, and its coefficients, power first."""
        if len(self.pieces) == 1:
            return t, self.pieces[0, 2:]
        piece = self._piece(t)
        return t - self.pieces[piece, 0], self.pieces[piece, 2:].T


ProfileLike = Profile | Curve | str | float | Sequence[Any] | Floats


def as_profile(given: ProfileLike) -> Profile | Curve:
    """A profile from a name, a number, a ramp's two ends, keys (t, h) or (t, h, slope), or functions.

    Keys without slopes are joined as PCHIP does, by a C¹ cubic that overshoots nowhere (Fritsch & Butland 1984).

    Raises
    ------
    InvalidDeformer
        Nothing of that kind; keys that do not ascend, or leave [0, 1].
    """
    if isinstance(given, Profile | Curve):
        return given
    if isinstance(given, str):
        if given not in NAMED:
            raise InvalidDeformer(f"there is no profile {given!r}; there are: {', '.join(NAMED)}")
        return _single(*NAMED[given])
    try:
        numbers = np.asarray(given, np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidDeformer(f"{given!r} is no profile: pass a name, numbers, keys or a Profile") from error
    if not np.isfinite(numbers).all():
        raise InvalidDeformer(f"the profile {numbers.tolist()} holds numbers that are not finite")
    if numbers.shape == ():
        return _single(float(numbers), 0.0, 0.0, 0.0)
    if numbers.shape == (2,):
        return _single(numbers[0], numbers[1] - numbers[0], 0.0, 0.0)
    if numbers.ndim == 2 and numbers.shape[1] in (2, 3) and len(numbers) > 1:
        return _keyed(numbers)
    raise InvalidDeformer(
        f"a profile of shape {numbers.shape} is not understood: pass one number, the two ends of a ramp, or two or "
        "more keys (t, value) or (t, value, slope)"
    )


def _single(*coefficients: float) -> Curve:
    return Curve(np.array([[0.0, 1.0, *coefficients]]))


def _keyed(keys: Floats) -> Curve:
    """Cubic Hermite pieces between keys; constant before the first and after the last."""
    t, h = keys[:, 0], keys[:, 1]
    width = np.diff(t)
    if t[0] < 0 or t[-1] > 1 or not (width > 0).all():
        raise InvalidDeformer(f"the keys of a profile must ascend within [0, 1]; they are at {t.tolist()}")
    if keys.shape[1] == 3:
        slope = keys[:, 2]
    else:
        from scipy.interpolate import pchip_interpolate

        slope = np.asarray(pchip_interpolate(t, h, t, der=1))
    secant = np.diff(h) / width
    square = (3 * secant - 2 * slope[:-1] - slope[1:]) / width
    cube = (slope[:-1] + slope[1:] - 2 * secant) / width**2
    pieces = [np.column_stack([t[:-1], t[1:], h[:-1], slope[:-1], square, cube])]
    if t[0] > 0:
        pieces.insert(0, np.array([[0.0, t[0], h[0], 0.0, 0.0, 0.0]]))
    if t[-1] < 1:
        pieces.append(np.array([[t[-1], 1.0, h[-1], 0.0, 0.0, 0.0]]))
    return Curve(np.vstack(pieces))


def _area(x: Floats, c: Floats) -> Floats:
    return np.asarray((((x * (c[3] / 4) + c[2] / 3) * x + c[1] / 2) * x + c[0]) * x)
