"""Twist: sections turn about the axis (Barr 1984, section 3.3). Volume is kept exactly."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
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
class Twist(ProfiledDeformer, SimilarDeformer):
    """Turn each section about the axis by angle h(t), h being the profile.

    Normals n become (c nx - s ny, s nx + c ny, f' (y nx - x ny) + nz) for an axis z and f = angle h; det J = 1
    (Barr 1984, section 3.3).

    Parameters
    ----------
    axis, origin, bounds
        See :class:`~pliant.space.axial.AxialDeformer`.
    angle
        Radians from the low bound to the high one, right-handed about the axis. Its control.
    profile
        Where the turning happens, see :class:`~pliant.space.profiled.ProfiledDeformer`.
    """

    angle: float = field(default=0.0, metadata={"unit": "radians"})

    parameters: ClassVar[tuple[str, ...]] = ("angle",)
    neutral: ClassVar[Mapping[str, float]] = MappingProxyType({"angle": 0.0})

    def _turn(self, q: Floats, numbers: Numbers) -> tuple[Any, Any]:
        return 1.0, numbers[0] * self._strength(q)

    def _turn_slopes(self, q: Floats) -> tuple[Any, Any]:
        return 0.0, self.angle * self._steepness(q)

    @property
    def _rule(self) -> Rule | None:
        return (self._curve, self.angle, 0.0) if isinstance(self._curve, Curve) else None
