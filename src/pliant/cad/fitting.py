"""Cubic B-splines through a map's images: knots where they are needed, until a stated tolerance is met."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.linalg import solve_banded

from pliant.errors import NotConverged

Floats = NDArray[np.float64]
DEGREE = 3
_MOST = 400  # spans along one direction


@dataclass(frozen=True, eq=False)
class Knots:
    """Breaks of a cubic spline, and how smooth it is at each.

    Parameters
    ----------
    breaks
        (k,) strictly ascending, ends included.
    multiplicities
        (k,) 1 where it is C², 2 where C¹, 3 where it may have a corner; 4 at the ends.
    """

    breaks: Floats
    multiplicities: NDArray[np.int32]

    @property
    def vector(self) -> Floats:
        """Each break as often as it counts."""
        return np.repeat(self.breaks, self.multiplicities)

    @property
    def sites(self) -> Floats:
        """Greville's abscissae: one a coefficient; interpolation there exists and is stable."""
        knots = self.vector
        return np.clip((knots[1:-3] + knots[2:-2] + knots[3:-1]) / 3, self.breaks[0], self.breaks[-1])

    def coefficients(self, values: Floats) -> Floats:
        """(n, ...) coefficients of the spline that takes values (n, ...) at the sites."""
        matrix = BSpline.design_matrix(self.sites, self.vector, DEGREE).todia()
        low, high = -int(matrix.offsets.min()), int(matrix.offsets.max())
        bands = np.zeros((low + high + 1, len(values)))
        for offset, row in zip(matrix.offsets, matrix.data, strict=True):
            bands[high - offset, : len(row)] = row
        return np.asarray(solve_banded((low, high), bands, values.reshape(len(values), -1))).reshape(values.shape)

    def split(self, spans: NDArray[np.bool_]) -> Knots:
        """With a break in the middle of each chosen span."""
        middle = (self.breaks[:-1] + self.breaks[1:])[spans] / 2
        breaks = np.concatenate([self.breaks, middle])
        order = np.argsort(breaks)
        counts = np.concatenate([self.multiplicities, np.ones(len(middle), np.int32)])
        return Knots(breaks[order], counts[order])

    def between(self, count: int = 3) -> Floats:
        """(spans, count) places inside the spans."""
        parts = (np.arange(count) + 0.5) / count
        return np.asarray(self.breaks[:-1, None] + np.diff(self.breaks)[:, None] * parts)


def refined(curves: Callable[[Floats], Floats], knots: Knots, tolerance: float) -> Knots:
    """Knots on which splines follow curves.

    Parameters
    ----------
    curves
        Parameters (n,) in, (n, m, 3) positions on m curves out.
    knots
        To begin with.
    tolerance
        The largest distance allowed, looked at in three places a span.

    Raises
    ------
    NotConverged
        Hundreds of spans do not suffice.
    """
    while True:
        spline = BSpline(knots.vector, knots.coefficients(curves(knots.sites)), DEGREE)
        places = knots.between()
        off = np.linalg.norm(spline(places.reshape(-1)) - curves(places.reshape(-1)), axis=-1).max(axis=1)
        bad = off.reshape(places.shape).max(axis=1) > tolerance
        if not bad.any():
            return knots
        if len(knots.breaks) > _MOST:
            raise NotConverged(
                f"{_MOST} spans leave a distance of {off.max():.3g}; {tolerance:.3g} is wanted: allow more, or deform "
                "more smoothly"
            )
        knots = knots.split(bad)
