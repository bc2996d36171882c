"""What is proved about det J of a map: the result of :func:`pliant.certify`."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Literal

import numpy as np

from pliant.mesh import Points
from pliant.numerics.ragged import frozen

Status = Literal["fold-free", "folds", "undecided"]
Method = Literal["coefficients", "exact", "bounds", "sampled"]


@dataclass(frozen=True, eq=False)
class Certificate:
    """Whether a map folds, and how it changes volume.

    Parameters
    ----------
    status
        ``"fold-free"``: det J > 0 everywhere, proved; the map is injective in a neighbourhood of every point.
        ``"folds"``: det J <= 0 at :attr:`point`. ``"undecided"``: neither, within the budget.
    lower, upper
        Proved bounds: lower <= det J <= upper everywhere. Infinite where nothing is proved.
    least, greatest
        The least and greatest det J that were found, between these bounds; None if nothing was looked at.
    point
        (3,) where in space ``least`` was found, before the deformation; None if nowhere in particular.
    injective
        True: no two points of space have the same image, proved. False: some have. None: not known.
    method
        ``"coefficients"`` of polynomials, ``"exact"`` arithmetic, ``"bounds"`` of a composition's parts, or
        ``"sampled"``: a search for folds only, which proves nothing when it finds none.
    subdivisions
        How many boxes were halved.
    """

    status: Status
    lower: float = -inf
    upper: float = inf
    least: float | None = None
    greatest: float | None = None
    point: Points | None = None
    injective: bool | None = None
    method: Method = "coefficients"
    subdivisions: int = 0

    def __post_init__(self) -> None:
        if self.point is not None:
            object.__setattr__(self, "point", frozen(self.point, np.float64))

    @property
    def volume_error(self) -> tuple[float, float]:
        """Bounds of the largest absolute value of det J - 1: what was found, and what it cannot exceed.

        A map with det J = 1 everywhere keeps the volume of whatever it deforms.
        """
        found = [abs(value - 1) for value in (self.least, self.greatest) if value is not None]
        return max(found, default=0.0), max(abs(self.lower - 1), abs(self.upper - 1))

    def __str__(self) -> str:
        bounds = f"{self.lower:.6g} <= det J <= {self.upper:.6g}"
        found = "" if self.least is None else f", found {self.least:.6g} to {self.greatest:.6g}"
        return f"{self.status} ({self.method}): {bounds}{found}"
