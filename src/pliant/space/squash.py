"""Squash and stretch: what the axis gains the sections lose, so that volume is kept everywhere, exactly."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidDeformer
from pliant.numerics.maps.sections import Entries
from pliant.space.axes import unit_axis
from pliant.space.axial import Numbers
from pliant.space.profile import Curve, ProfileLike
from pliant.space.profiled import ProfiledDeformer

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Squash(ProfiledDeformer):
    """Stretch the axis by e = 1 + (factor - 1) h(t) and scale the sections by 1 / sqrt(e): det J = 1.

    The section through the origin stays. With the profile "bump" (mean 1, 0 at both ends) the piece between the
    bounds becomes ``factor`` times as long, and what lies beyond is only shifted; with "constant" all space is
    stretched alike.

    Parameters
    ----------
    axis, origin, bounds
        See :class:`~pliant.space.axial.AxialDeformer`.
    factor
        Above 1 it stretches, below it squashes. Its control.
    profile
        Where the stretching happens, see :class:`~pliant.space.profiled.ProfiledDeformer`; functions need their
        integral.

    Raises
    ------
    InvalidDeformer
        A factor at which the axis would fold: e is not positive everywhere.
    """

    factor: float = 1.0
    profile: ProfileLike = "bump"

    parameters: ClassVar[tuple[str, ...]] = ("factor",)
    neutral: ClassVar[Mapping[str, float]] = MappingProxyType({"factor": 1.0})

    def __post_init__(self) -> None:
        super().__post_init__()
        if self._curve.integral is None:
            raise InvalidDeformer("a squash needs its profile's integral: Profile(value, slope, integral)")
        ends = self._curve.pieces[:, 0] if isinstance(self._curve, Curve) else np.empty(0)
        h = np.asarray(self._curve.value(np.union1d(np.linspace(0, 1, 1025), ends)))
        least = float((1 + (self.factor - 1) * h).min())
        if least <= 0:
            raise InvalidDeformer(
                f"a squash by {self.factor:g} folds the axis: its profile reaches {h.max():g}, so that the factor must "
                f"be above {1 - 1 / h.max():g}; the profile 'constant' takes any positive factor"
                if self.factor < 1
                else f"a squash by {self.factor:g} folds the axis: its profile reaches {h.min():g}, below zero"
            )

    def _table(self, q: Floats, numbers: Numbers) -> Entries:
        gain = numbers[0] - 1
        narrower = 1 / np.sqrt(1 + gain * self._strength(q)) - 1
        start = self._summed(np.array([unit_axis(self.axis) @ np.asarray(self.origin)]))
        return {(0, 1): narrower, (1, 2): narrower, (2, 0): gain * (self._summed(q) - start)}

    def _slopes(self, q: Floats) -> Entries:
        gain, h = self.factor - 1, self._strength(q)
        narrowing = -0.5 * gain * self._steepness(q) * (1 + gain * h) ** -1.5
        return {(0, 1): narrowing, (1, 2): narrowing, (2, 0): gain * h}

    def _summed(self, q: Floats) -> Any:
        """The integral of h from the low bound to q; beyond the bounds h stays as it is there."""
        t = self._clamped(q)
        beyond = q - self.bounds[0] - self._width * t
        assert self._curve.integral is not None
        return self._width * np.asarray(self._curve.integral(t)) + beyond * self._strength(q)
