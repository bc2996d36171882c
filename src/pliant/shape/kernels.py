"""Kernels: how alike the displacements of two points are.

A kernel k(x, y) is the covariance of a random displacement field. A scalar kernel stands for k(x, y) I_3: the three
coordinates are independent and alike, and everything is factorised once instead of three times. ``scale`` is always
an amplitude, a length: the standard deviation of each coordinate of the displacement.

Kernels combine to kernels: ``+``, ``*``, ``2.0 *`` (of the covariance), and the functions in
:mod:`pliant.shape.kernel_algebra`. Each is positive semi-definite by construction.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import as_points
from pliant.numerics.compute.chunks import for_chunks

Floats = NDArray[np.float64]

_BLOCK = 131_072  # covariances a block: their temporaries stay in cache


class Kernel(ABC):
    """A covariance function of displacements."""

    scalar = True

    def __call__(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Covariances between (n, 3) and (m, 3) points: (n, m), or (n, 3, m, 3) where they are matrices."""
        one, two = as_points(x, borrow=True), as_points(y, borrow=True)
        out = np.empty((len(one), len(two)) if self.scalar else (len(one), 3, len(two), 3))

        def work(first: int, stop: int) -> None:
            out[first:stop] = self.block(one[first:stop], two)

        for_chunks(work, len(one), max(1, _BLOCK // max(1, len(two))))
        return out

    @abstractmethod
    def block(self, x: Floats, y: Floats) -> Floats:
        """As :meth:`__call__`, for few points and in the calling thread."""

    @abstractmethod
    def slopes(self, x: Floats, y: Floats) -> Floats:
        """The derivative of :meth:`block` by x: one more axis (3,) at the end.

        Raises
        ------
        NotDifferentiable
            The kernel has no derivative that is known.
        """

    @abstractmethod
    def diagonal(self, x: Floats) -> Floats:
        """(n,) variances k(x, x) at points, or (n, 3, 3) covariance matrices."""

    def __add__(self, other: Kernel) -> Kernel:
        from pliant.shape.kernel_algebra import Sum

        return Sum(self, other) if isinstance(other, Kernel) else NotImplemented

    def __mul__(self, other: Kernel | float) -> Kernel:
        from pliant.shape.kernel_algebra import Product, Varying

        if isinstance(other, Kernel):
            return Product(self, other)
        if not isinstance(other, int | float | np.floating | np.integer):
            return NotImplemented
        return Varying(self, float(np.sqrt(positive("the factor of a kernel", float(other)))))

    __rmul__ = __mul__


@dataclass(frozen=True)
class Stationary(Kernel):
    """A kernel of the distance r = |x − y| alone.

    Parameters
    ----------
    sigma
        How far apart points stop moving alike: a length.
    scale
        The standard deviation of each coordinate: a length.
    """

    sigma: float
    scale: float = 1.0

    def __post_init__(self) -> None:
        for each in fields(self):
            positive(f"{each.name} of a {type(self).__name__}", getattr(self, each.name))

    def block(self, x: Floats, y: Floats) -> Floats:
        """(n, m) scale² times the profile of (r / sigma)²."""
        return np.asarray(self.scale**2 * self.profile(squares(x, y, self.sigma)))

    def slopes(self, x: Floats, y: Floats) -> Floats:
        slope = 2 * (self.scale / self.sigma) ** 2 * self.slope(squares(x, y, self.sigma))
        return np.asarray(slope[:, :, None] * (x[:, None] - y))

    def diagonal(self, x: Floats) -> Floats:
        """(n,) scale² everywhere."""
        return np.full(len(x), float(self.scale**2))

    @abstractmethod
    def profile(self, s: Floats) -> Floats:
        """The correlation at s = (r / sigma)²; may overwrite s."""

    @abstractmethod
    def slope(self, s: Floats) -> Floats:
        """The derivative of the profile by s; zero at s = 0 where there is none."""


@dataclass(frozen=True)
class GaussianKernel(Stationary):
    """scale² exp(−r² / sigma²): Scalismo's convention, without a factor of one half in the exponent.

    Parameters
    ----------
    sigma
        The distance at which correlation has fallen to 1/e, in the mesh's unit; positive.
    scale
        The amplitude: the standard deviation of each coordinate of a displacement, in the mesh's unit.
    """

    def profile(self, s: Floats) -> Floats:
        np.negative(s, out=s)
        return np.asarray(np.exp(s, out=s))

    def slope(self, s: Floats) -> Floats:
        return np.asarray(-np.exp(-s))


@dataclass(frozen=True)
class ExponentialKernel(Stationary):
    """scale² exp(−r / sigma): rough fields, continuous but without derivative.

    Parameters
    ----------
    sigma
        The distance at which correlation has fallen to 1/e, in the mesh's unit; positive.
    scale
        The amplitude: the standard deviation of each coordinate of a displacement, in the mesh's unit.
    """

    def profile(self, s: Floats) -> Floats:
        return np.asarray(np.exp(-np.sqrt(s)))

    def slope(self, s: Floats) -> Floats:
        r = np.sqrt(s)
        return np.asarray(np.divide(-np.exp(-r), 2 * r, out=np.zeros_like(r), where=r > 0))


@dataclass(frozen=True)
class MaternKernel(Stationary):
    """Matérn's kernel for fields with one derivative, or two (Rasmussen & Williams 2006, eq. 4.17).

    Parameters
    ----------
    sigma
        The length over which fields vary, in the mesh's unit; positive.
    scale
        The amplitude: the standard deviation of each coordinate of a displacement, in the mesh's unit.
    smoothness
        ν: 1.5 or 2.5. (ν = 0.5 is the exponential kernel, ν = ∞ a Gaussian one.)
    """

    smoothness: float = 2.5

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.smoothness not in (1.5, 2.5):
            raise InvalidParameter(f"the smoothness of a MaternKernel is 1.5 or 2.5, not {self.smoothness}")

    def profile(self, s: Floats) -> Floats:
        r = np.sqrt(2 * self.smoothness * s)
        return np.asarray((1 + r + (r * r / 3 if self.smoothness == 2.5 else 0)) * np.exp(-r))

    def slope(self, s: Floats) -> Floats:
        r = np.sqrt(2 * self.smoothness * s)
        return np.asarray((-5 / 6 * (1 + r) if self.smoothness == 2.5 else -1.5) * np.exp(-r))


@dataclass(frozen=True)
class RationalQuadraticKernel(Stationary):
    """scale² (1 + r² / (2 α sigma²))^(−α): Gaussian kernels of many widths (Rasmussen & Williams 2006, eq. 4.19).

    Parameters
    ----------
    sigma
        The distance at which one begins to feel it, in the mesh's unit; positive.
    scale
        The amplitude: the standard deviation of each coordinate of a displacement, in the mesh's unit.
    alpha
        α: how alike the widths are; large ones give a Gaussian kernel.
    """

    alpha: float = 1.0

    def profile(self, s: Floats) -> Floats:
        return np.asarray((1 + s / (2 * self.alpha)) ** -self.alpha)

    def slope(self, s: Floats) -> Floats:
        return np.asarray(-0.5 * (1 + s / (2 * self.alpha)) ** (-self.alpha - 1))


@dataclass(frozen=True)
class InverseMultiquadricKernel(Stationary):
    """scale² / sqrt(1 + r² / sigma²): long tails (Hardy 1971).

    Parameters
    ----------
    sigma
        The distance at which correlation has fallen to 0.71, in the mesh's unit; positive.
    scale
        The amplitude: the standard deviation of each coordinate of a displacement, in the mesh's unit.
    """

    def profile(self, s: Floats) -> Floats:
        return np.asarray(1 / np.sqrt(1 + s))

    def slope(self, s: Floats) -> Floats:
        return np.asarray(-0.5 * (1 + s) ** -1.5)


def squares(x: Floats, y: Floats, unit: float) -> Floats:
    """(n, m) squared distances in squared units: exactly zero between equal points."""
    one, two = x / unit, y / unit
    total = np.subtract.outer(one[:, 0], two[:, 0])
    np.square(total, out=total)
    for axis in (1, 2):
        part = np.subtract.outer(one[:, axis], two[:, axis])
        total += np.square(part, out=part)
    return np.asarray(total)


def positive(what: str, value: Any) -> float:
    """The value, if it is a positive number.

    Raises
    ------
    InvalidParameter
        With what it is for.
    """
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise InvalidParameter(f"{what} is {repr(value)[:40]}; it must be a number above zero") from error
    if not 0 < number * number < np.inf or number < 0:
        raise InvalidParameter(f"{what} is {number:g}; it must be above zero, and its square too, and finite")
    return number
