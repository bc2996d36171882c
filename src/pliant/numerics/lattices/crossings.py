"""Where cubic polynomials in Bernstein form first come down to zero: a proved lower bound."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.lattices.determinants import UNIT

Floats = NDArray[np.float64]

CUBIC_FROM_SAMPLES = np.array([[6, 0, 0, 0], [-5, 18, -9, 2], [2, -9, 18, -5], [0, 0, 0, 6]]) / 6
"""Bernstein coefficients of a cubic from its values at 0, 1/3, 2/3 and 1."""

_FINEST = 2.0**-32


def positive_until(coefficients: Floats) -> Floats:
    """(n,) how far from 0 towards 1 cubics with Bernstein coefficients (n, 4) are proved to be positive.

    Pieces of [0, 1], as long as they can be, are passed one after another while all coefficients on them are
    positive, with room for the roundings of the restriction.
    """
    reached, step = np.zeros(len(coefficients)), np.ones(len(coefficients))
    room = 32 * UNIT * np.abs(coefficients).max(axis=1, initial=0.0)
    active = np.arange(len(coefficients))
    while len(active):
        start = reached[active]
        stop = np.minimum(start + step[active], 1.0)
        piece = np.einsum("nst,nt->ns", restriction(start, stop), coefficients[active])
        passed = (piece > room[active, None]).all(axis=1)
        reached[active[passed]] = stop[passed]
        step[active] *= np.where(passed, 2.0, 0.5)
        active = active[(reached[active] < 1) & (step[active] > _FINEST)]
    return reached


def restriction(start: Floats, stop: Floats) -> Floats:
    """(n, 4, 4) matrices: Bernstein coefficients of cubics on [start, stop] from those on [0, 1].

    By polar forms: weights are not negative and add up to one, wherever the piece lies within [0, 1].
    """
    rows = [_polar([start] * (3 - i) + [stop] * i) for i in range(4)]
    return np.stack(rows, axis=1)


def _polar(at: list[Floats]) -> Floats:
    """(n, 4) weights of the polar form of a cubic at three parameters each."""
    left = np.broadcast_to(np.eye(4), (len(at[0]), 4, 4))
    for t in at:
        left = (1 - t)[:, None, None] * left[:, :-1] + t[:, None, None] * left[:, 1:]
    return left[:, 0]
