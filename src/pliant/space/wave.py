"""Wave: ripples around the axis, as on a pond."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidDeformer
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.numerics.maps.sections import Entries
from pliant.space.axial import Numbers
from pliant.space.profile import ProfileLike
from pliant.space.profiled import ProfiledDeformer

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Wave(ProfiledDeformer):
    """Move points along the axis by amplitude h(t) cos(2 pi waves t - phase), t growing with the distance; det J = 1.

    With phase 0, no inner bound and a level profile it is smooth on the axis too; elsewhere it has a tip there, whose
    Jacobian is taken as the identity.

    Parameters
    ----------
    axis, origin
        See :class:`~pliant.space.axial.AxialDeformer`.
    bounds
        Distances from the axis between which the wave runs.
    amplitude
        In the mesh's unit. A control; at rest it is 0.
    waves
        How many waves there are between the bounds. A control.
    phase
        In radians; as it grows the ripples travel outwards. A control.
    profile
        The amplitude over the distance, see :class:`~pliant.space.profiled.ProfiledDeformer`.
    """

    amplitude: float = field(default=0.0, metadata={"unit": "length"})
    waves: float = 1.0
    phase: float = field(default=0.0, metadata={"unit": "radians"})
    profile: ProfileLike = "constant"

    parameters: ClassVar[tuple[str, ...]] = ("amplitude", "waves", "phase")
    neutral: ClassVar[Mapping[str, float]] = MappingProxyType({"amplitude": 0.0})
    radial: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.bounds[0] < 0:
            raise InvalidDeformer(f"bounds {self.bounds} are distances from the axis: they must not be negative")

    def _table(self, q: Floats, numbers: Numbers) -> Entries:
        amplitude, waves, phase = numbers
        angle = 2 * np.pi * waves * self._clamped(q) - phase
        return {(2, 0): amplitude * self._strength(q) * np.cos(angle)}

    def _slopes(self, q: Floats) -> Entries:
        frequency = 2 * np.pi * self.waves
        angle = frequency * self._clamped(q) - self.phase
        turning = np.where(self._between(q), frequency / self._width, 0.0)
        slope = self._steepness(q) * np.cos(angle) - self._strength(q) * turning * np.sin(angle)
        return {(2, 0): self.amplitude * slope}

    def inverse(self, points: ArrayLike, *, tolerance: float = 1e-10, iterations: int = 50) -> Points:
        """Where (n, 3) points came from, exactly: the tolerance is not needed."""
        return self._undone(points, lambda q: {(2, 0): -self._entries(q)[2, 0]})

    def _extent(self, target: PolygonMesh | ArrayLike) -> tuple[float, float]:
        farthest = float(self._sections(as_points(target)).max())
        return 0.0, farthest or 1.0
