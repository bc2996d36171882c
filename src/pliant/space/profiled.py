"""Deformations along an axis whose strength follows a profile."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pliant.space.axial import AxialDeformer
from pliant.space.profile import Curve, Profile, ProfileLike, as_profile

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class ProfiledDeformer(AxialDeformer):
    """A deformation whose strength is a function h of t, the position in units of the bounds.

    Parameters
    ----------
    profile
        A name ("ramp" 0 to 1, "constant" 1, "smooth" 0 to 1 with level ends, "bump"), a number, the two ends of a
        ramp, keys (t, h) or (t, h, slope), or a :class:`~pliant.space.profile.Profile` of functions.
    """

    profile: ProfileLike = "ramp"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._curve  # noqa: B018 -- what is no profile is refused now, not later

    @cached_property
    def _curve(self) -> Curve | Profile:
        return as_profile(self.profile)

    def _strength(self, q: Floats) -> Floats:
        """H at the sections q."""
        return np.asarray(self._curve.value(self._clamped(q)), np.float64)

    def _steepness(self, q: Floats) -> Floats:
        """The derivative of h by q: zero beyond the bounds."""
        slope = np.asarray(self._curve.slope(self._clamped(q)), np.float64)
        return np.asarray(np.where(self._between(q), slope / self._width, 0.0))
