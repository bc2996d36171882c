"""Losses that forgive: how much a distance counts (Huber 1964; Beaton & Tukey 1974)."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter

Floats = NDArray[np.float64]
Loss = Literal["squares", "huber", "tukey"]

_TURN = {"huber": 1.345, "tukey": 4.685}  # in standard deviations: 95 % efficient where the noise is normal


def weights(r: Floats, loss: Loss) -> Floats:
    """(n,) ρ'(r) / r at distances r in standard deviations: 1 where they count in full.

    Raises
    ------
    InvalidParameter
        An unknown word.
    """
    if loss == "squares":
        return np.ones_like(r)
    turn = _turn(loss)
    if loss == "huber":
        return np.asarray(turn / np.maximum(r, turn))
    return np.asarray(np.maximum(1 - (r / turn) ** 2, 0.0) ** 2)


def losses(r: Floats, loss: Loss) -> Floats:
    """(n,) ρ(r), r² / 2 for small r.

    Raises
    ------
    InvalidParameter
        An unknown word.
    """
    if loss == "squares":
        return np.asarray(r**2 / 2)
    turn = _turn(loss)
    if loss == "huber":
        return np.asarray(np.where(r <= turn, r**2 / 2, turn * (r - turn / 2)))
    return np.asarray(turn**2 / 6 * (1 - np.maximum(1 - (r / turn) ** 2, 0.0) ** 3))


def _turn(loss: str) -> float:
    if loss not in _TURN:
        raise InvalidParameter(f"a loss is 'squares', 'huber' or 'tukey', not {loss!r}")
    return _TURN[loss]
