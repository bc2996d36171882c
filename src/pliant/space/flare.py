"""Flare: both ends open or close, and the middle bulges."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from pliant.space.axial import Numbers
from pliant.space.profile import Curve
from pliant.space.similar import Rule, SimilarDeformer

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Flare(SimilarDeformer):
    """Scale each section by r = start (1 - t) + end t + 4 bulge t (1 - t), t being 0 at the low bound, 1 at the high.

    Parameters
    ----------
    axis, origin, bounds
        See :class:`~pliant.space.axial.AxialDeformer`.
    start, end
        The scales at the low and at the high bound. Controls.
    bulge
        What the scale in the middle exceeds their mean by. A control.
    """

    start: float = 1.0
    end: float = 1.0
    bulge: float = 0.0

    parameters: ClassVar[tuple[str, ...]] = ("start", "end", "bulge")
    neutral: ClassVar[Mapping[str, float]] = MappingProxyType({"start": 1.0, "end": 1.0, "bulge": 0.0})

    def _turn(self, q: Floats, numbers: Numbers) -> tuple[Any, Any]:
        start, end, bulge = numbers
        t = self._clamped(q)
        return 1.0 + ((start - 1.0) * (1.0 - t) + (end - 1.0) * t + 4.0 * bulge * t * (1.0 - t)), 0.0

    def _turn_slopes(self, q: Floats) -> tuple[Any, Any]:
        slope = self.end - self.start + 4.0 * self.bulge * (1.0 - 2.0 * self._clamped(q))
        return np.where(self._between(q), slope / self._width, 0.0), 0.0

    @property
    def _rule(self) -> Rule:
        linear = self.end - self.start + 4.0 * self.bulge
        return Curve(np.array([[0.0, 1.0, self.start - 1.0, linear, -4.0 * self.bulge, 0.0]])), 0.0, 1.0
