"""Taper: sections grow or shrink along the axis (Barr 1984, section 3.2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from pliant.space.axial import Numbers
from pliant.space.profile import Curve
from pliant.space.profiled import ProfiledDeformer
from pliant.space.similar import Rule, SimilarDeformer

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Taper(ProfiledDeformer, SimilarDeformer):
    """Scale each section by r = 1 + (factor - 1) h(t), h being the profile.

    Normals n become (r nx, r ny, r^2 nz - r r' (x nx + y ny)) for an axis z; det J = r^2
    (Barr 1984, section 3.2).

    Parameters
    ----------
    axis, origin, bounds
        See :class:`~pliant.space.axial.AxialDeformer`.
    factor
        The scale of the section at the high bound, beside 1 at the low one. Its control.
    profile
        How the scale changes between them, see :class:`~pliant.space.profiled.ProfiledDeformer`.
    """

    factor: float = 1.0

    parameters: ClassVar[tuple[str, ...]] = ("factor",)
    neutral: ClassVar[Mapping[str, float]] = MappingProxyType({"factor": 1.0})

    def _turn(self, q: Floats, numbers: Numbers) -> tuple[Any, Any]:
        return 1.0 + (numbers[0] - 1.0) * self._strength(q), 0.0

    def _turn_slopes(self, q: Floats) -> tuple[Any, Any]:
        return (self.factor - 1.0) * self._steepness(q), 0.0

    @property
    def _rule(self) -> Rule | None:
        return (self._curve, 0.0, self.factor - 1.0) if isinstance(self._curve, Curve) else None
