"""Sine: sections slide sideways in a wave that runs along the axis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.mesh import Points
from pliant.numerics.maps.sections import Entries
from pliant.space.affine import Axis
from pliant.space.axes import unit_axis
from pliant.space.axial import Numbers
from pliant.space.profile import ProfileLike
from pliant.space.profiled import ProfiledDeformer

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Sine(ProfiledDeformer):
    """Move each section along the normal by amplitude h(t) sin(2 pi waves t - phase); det J = 1.

    Parameters
    ----------
    axis, origin, bounds
        See :class:`~pliant.space.axial.AxialDeformer`.
    normal
        The direction of the movement; what it has along the axis is left out. None = any across the axis.
    amplitude
        In the mesh's unit. A control; at rest it is 0.
    waves
        How many waves there are between the bounds. A control.
    phase
        In radians; as it grows the wave travels along the axis. A control.
    profile
        The amplitude along the axis, see :class:`~pliant.space.profiled.ProfiledDeformer`.
    """

    normal: Axis | None = None
    amplitude: float = field(default=0.0, metadata={"unit": "length"})
    waves: float = 1.0
    phase: float = field(default=0.0, metadata={"unit": "radians"})
    profile: ProfileLike = "constant"

    parameters: ClassVar[tuple[str, ...]] = ("amplitude", "waves", "phase")
    neutral: ClassVar[Mapping[str, float]] = MappingProxyType({"amplitude": 0.0})

    def __post_init__(self) -> None:
        super().__post_init__()
        self._frame  # noqa: B018 -- a normal along the axis is refused now, not later

    @cached_property
    def _frame(self) -> Floats:
        if self.normal is None:
            return super()._frame
        return self._frame_across(unit_axis(self.normal, "normal"), unit_axis(self.axis))

    def _table(self, q: Floats, numbers: Numbers) -> Entries:
        amplitude, waves, phase = numbers
        angle = 2 * np.pi * waves * self._clamped(q) - phase
        return {(0, 0): amplitude * self._strength(q) * np.sin(angle)}

    def _slopes(self, q: Floats) -> Entries:
        frequency = 2 * np.pi * self.waves
        angle = frequency * self._clamped(q) - self.phase
        turning = np.where(self._between(q), frequency / self._width, 0.0)
        slope = self._steepness(q) * np.sin(angle) + self._strength(q) * turning * np.cos(angle)
        return {(0, 0): self.amplitude * slope}

    def inverse(self, points: ArrayLike, *, tolerance: float = 1e-10, iterations: int = 50) -> Points:
        """Where (n, 3) points came from, exactly: the tolerance is not needed."""
        return self._undone(points, lambda q: {(0, 0): -self._entries(q)[0, 0]})
