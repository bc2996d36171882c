"""Kernels made of kernels: sums, products, amplitudes that vary, warped space, symmetry, change of one into another.

Each rule keeps positive semi-definiteness. Scalar kernels stay scalar; where one operand is matrix-valued, a scalar
one counts as k I_3.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidParameter, NotDifferentiable
from pliant.shape.kernels import Floats, Kernel, positive


@dataclass(frozen=True)
class Sum(Kernel):
    """The field that is the sum of two independent ones."""

    first: Kernel
    second: Kernel

    @property
    def scalar(self) -> bool:  # type: ignore[override]
        return self.first.scalar and self.second.scalar

    def block(self, x: Floats, y: Floats) -> Floats:
        return self._promoted(self.first, self.first.block(x, y)) + self._promoted(self.second, self.second.block(x, y))

    def slopes(self, x: Floats, y: Floats) -> Floats:
        one, two = self.first.slopes(x, y), self.second.slopes(x, y)
        return self._promoted(self.first, one) + self._promoted(self.second, two)

    def diagonal(self, x: Floats) -> Floats:
        one, two = (each.diagonal(x) for each in (self.first, self.second))
        if self.scalar:
            return one + two
        return matrix_diagonal(one) + matrix_diagonal(two)

    def _promoted(self, kernel: Kernel, values: Floats) -> Floats:
        return promoted(values) if kernel.scalar and not self.scalar else values


@dataclass(frozen=True)
class Product(Kernel):
    """The entrywise product: alike only where both say so. At most one operand may be matrix-valued."""

    first: Kernel
    second: Kernel

    def __post_init__(self) -> None:
        if not self.first.scalar and not self.second.scalar:
            raise InvalidParameter("two matrix-valued kernels have no product: make one of them scalar")

    @property
    def scalar(self) -> bool:  # type: ignore[override]
        return self.first.scalar and self.second.scalar

    def block(self, x: Floats, y: Floats) -> Floats:
        return self._factor(self.first, self.first.block(x, y)) * self._factor(self.second, self.second.block(x, y))

    def slopes(self, x: Floats, y: Floats) -> Floats:
        one, two = (self._factor(each, each.block(x, y))[..., None] for each in (self.first, self.second))
        slopes = [self._factor(each, each.slopes(x, y)) for each in (self.first, self.second)]
        return np.asarray(slopes[0] * two + one * slopes[1])

    def diagonal(self, x: Floats) -> Floats:
        one, two = (each.diagonal(x) for each in (self.first, self.second))
        if self.scalar:
            return one * two
        scalar, matrix = (one, two) if self.first.scalar else (two, one)
        return np.asarray(scalar[:, None, None] * matrix)

    def _factor(self, kernel: Kernel, values: Floats) -> Floats:
        """Ready to be multiplied: scalars beside matrices get axes of length one."""
        return values[:, None, :, None] if kernel.scalar and not self.scalar else values


@dataclass(frozen=True)
class Varying(Kernel):
    """a(x) k(x, y) a(y): fields multiplied with an amplitude, which may vary in space.

    Parameters
    ----------
    kernel
        Of the field that is multiplied.
    amplitude
        A number, or a function from (n, 3) points to (n,) numbers.
    gradient
        Of the amplitude: from (n, 3) points to (n, 3); needed for Jacobians only.
    """

    kernel: Kernel
    amplitude: float | Callable[[Floats], Floats]
    gradient: Callable[[Floats], Floats] | None = None

    @property
    def scalar(self) -> bool:  # type: ignore[override]
        return self.kernel.scalar

    def block(self, x: Floats, y: Floats) -> Floats:
        if not callable(self.amplitude):
            return np.asarray(self.amplitude**2 * self.kernel.block(x, y))
        return self._times(self.kernel.block(x, y), self._amplitude(x), self._amplitude(y))

    def slopes(self, x: Floats, y: Floats) -> Floats:
        slopes = self.kernel.slopes(x, y)
        if not callable(self.amplitude):
            return np.asarray(self.amplitude**2 * slopes)
        if self.gradient is None:
            raise NotDifferentiable("the amplitude of a Varying kernel has no known gradient: give gradient=")
        ax, ay, slope = self._amplitude(x), self._amplitude(y), np.asarray(self.gradient(x), np.float64)
        axes = (1, 1, 1) if not self.scalar else (1,)
        values = self.kernel.block(x, y)
        own = self._times(values, np.ones(len(x)), ay)[..., None] * slope.reshape(len(x), *axes, 3)
        return np.asarray(np.moveaxis(self._times(np.moveaxis(slopes, -1, 0), ax, ay), 0, -1) + own)

    def diagonal(self, x: Floats) -> Floats:
        squares = self._amplitude(x) ** 2
        return np.asarray(self.kernel.diagonal(x) * (squares if self.scalar else squares[:, None, None]))

    def _amplitude(self, x: Floats) -> Floats:
        if not callable(self.amplitude):
            return np.full(len(x), float(self.amplitude))
        values = np.asarray(self.amplitude(x), np.float64)
        if values.shape != (len(x),) or not np.isfinite(values).all():
            raise InvalidParameter(f"an amplitude must give one finite number a point; it gave shape {values.shape}")
        return values

    def _times(self, values: Floats, ax: Floats, ay: Floats) -> Floats:
        """Values (..., n, m) or (..., n, 3, m, 3) times a(x) a(y)."""
        outer = np.multiply.outer(ax, ay)
        return np.asarray(values * (outer if self.scalar else outer[:, None, :, None]))


@dataclass(frozen=True)
class Warped(Kernel):
    """k(w(x), w(y)): what is near and far is told after a map of space. Displacements are not turned."""

    kernel: Kernel
    map: SpaceDeformer

    @property
    def scalar(self) -> bool:  # type: ignore[override]
        return self.kernel.scalar

    def block(self, x: Floats, y: Floats) -> Floats:
        return self.kernel.block(self.map(x), self.map(y))

    def slopes(self, x: Floats, y: Floats) -> Floats:
        slopes, jacobian = self.kernel.slopes(self.map(x), self.map(y)), self.map.jacobian(x)
        return np.asarray(np.einsum("n...j,njk->n...k", slopes, jacobian))

    def diagonal(self, x: Floats) -> Floats:
        return self.kernel.diagonal(self.map(x))


def change_point(before: Kernel, beyond: Kernel, origin: ArrayLike, normal: ArrayLike, width: float) -> Kernel:
    """One kernel before a plane, another beyond it, and a smooth change between: w k₁ w + (1 − w) k₂ (1 − w).

    Parameters
    ----------
    before, beyond
        The kernels.
    origin, normal
        (3,) a point on the plane, and the direction of beyond.
    width
        A length: the weight w changes from 0.88 to 0.12 over four times as much.

    Raises
    ------
    InvalidParameter
        A width that is not positive, a normal that is zero.
    """
    positive("the width of a change", width)
    place = np.asarray(origin, np.float64)
    this, that = (_Side(place, sign * unit(normal), width) for sign in (-1.0, 1.0))
    return Varying(before, this, this.gradient) + Varying(beyond, that, that.gradient)


@dataclass(frozen=True, eq=False)
class _Side:
    """A logistic function that rises from 0 to 1 across a plane."""

    origin: Floats
    normal: Floats
    width: float

    def __call__(self, x: Floats) -> Floats:
        return np.asarray(0.5 + 0.5 * np.tanh((x - self.origin) @ self.normal / (2 * self.width)))

    def gradient(self, x: Floats) -> Floats:
        value = self(x)
        return np.asarray(np.multiply.outer(value * (1 - value) / self.width, self.normal))


def promoted(values: Floats) -> Floats:
    """(n, 3, m, 3, ...) k I_3 from (n, m, ...)."""
    result = np.zeros((len(values), 3, values.shape[1], 3, *values.shape[2:]))
    for axis in range(3):
        result[:, axis, :, axis] = values
    return result


def matrix_diagonal(values: Floats) -> Floats:
    """(n, 3, 3) covariance matrices from those, or from (n,) variances."""
    return values if values.ndim == 3 else values[:, None, None] * np.eye(3)


def unit(direction: ArrayLike) -> Floats:
    """(3,) a unit vector.

    Raises
    ------
    InvalidParameter
        The direction is zero, or not three finite numbers.
    """
    vector = np.asarray(direction, np.float64)
    length = float(np.linalg.norm(vector)) if vector.shape == (3,) else 0.0
    if not 0 < length < np.inf:
        raise InvalidParameter(f"a direction is three numbers, not all zero; given: {direction!r}")
    return np.asarray(vector / length)
