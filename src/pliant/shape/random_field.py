"""A random field as a map of space: x + mean(x) + sum_j a_j ψ_j(x), for any shape that lies in it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from pliant.deformer import Controls, SpaceDeformer, Target, checked_controls
from pliant.mesh import as_points
from pliant.numerics.ragged import frozen
from pliant.shape.coefficient_binding import CoefficientBinding
from pliant.shape.kernels import Floats
from pliant.shape.low_rank import LowRank


@dataclass(frozen=True, eq=False)
class RandomField(SpaceDeformer):
    """A low-rank Gaussian process with coefficients: a smooth map of all of R³.

    At rest, with all coefficients zero, it is the mean of the process. Linear in the coefficients, each of which is
    standard normal in the process. Far from the centres of the kernel all goes to the prior's mean, as the kernel does.

    Parameters
    ----------
    process
        Fields and mean.
    coefficients
        (k,) k = 3 r for scalar fields, number 3 j + c moving coordinate c along field j; None = zeros.
    prior
        A map that the process adds to; None = the identity.
    """

    process: LowRank
    coefficients: ArrayLike | None = None
    prior: SpaceDeformer | None = None

    def __post_init__(self) -> None:
        given = np.zeros(self._count) if self.coefficients is None else self.coefficients
        object.__setattr__(self, "coefficients", frozen(checked_controls(given, (self._count,)), np.float64))

    @property
    def rest(self) -> Controls:
        """(k,) zeros."""
        return np.zeros(self._count)

    @property
    def controls(self) -> Controls:
        """(k,) the coefficients."""
        return np.asarray(self.coefficients)

    def moved(self, controls: ArrayLike) -> Self:
        """The same process with other coefficients."""
        return replace(self, coefficients=checked_controls(controls, (self._count,)))

    def bind(self, target: Target) -> CoefficientBinding:
        """Evaluate the fields at the target's points."""
        points = as_points(target)
        base = (points if self.prior is None else self.prior(points)) + self.process.mean(points)
        return CoefficientBinding(points, base, self.process.at(points), self.controls)

    def jacobian(self, points: ArrayLike) -> Floats:
        places = as_points(points, borrow=True)
        start = np.eye(3) if self.prior is None else self.prior.jacobian(places)
        return np.asarray(start + self.process.slopes(places, self.controls))

    @cached_property
    def _count(self) -> int:
        return len(self.process.deviations) * (3 if self.process.kernel.scalar else 1)
