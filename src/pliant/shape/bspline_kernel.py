"""The B-spline kernel: the field that a cubic B-spline lattice makes when its control points move at random.

k(x, y) = scale² prod_axes 2 sum_i β(x / h − i) β(y / h − i) with the cubic B-spline β and lattice spacing h, as in
Scalismo (after Opfer 2006). It vanishes where points are a support apart along any axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.shape.kernels import Floats, Kernel, positive


@dataclass(frozen=True)
class BSplineKernel(Kernel):
    """Cubic B-splines on a lattice that has a node at the origin.

    Parameters
    ----------
    support
        The width of one B-spline, four lattice spacings: points farther apart move independently.
    scale
        The standard deviation of each coordinate at the nodes, a length; between them it is up to 11 % less.
    """

    support: float
    scale: float = 1.0

    def __post_init__(self) -> None:
        positive("support of a BSplineKernel", self.support)
        positive("scale of a BSplineKernel", self.scale)

    @classmethod
    def multi_scale(cls, support: float, scale: float, levels: int) -> Kernel:
        """The sum over levels of B-spline kernels, each of half the support and half the scale of the one before.

        Parameters
        ----------
        support
            How far the first level reaches: a length.
        scale
            Its standard deviation of displacements: a length.
        levels
            How many: 1 to 20.

        Raises
        ------
        InvalidParameter
            No level, or more than 20.
        """
        if not 1 <= levels <= 20:
            raise InvalidParameter(f"a multi-scale kernel has 1 to 20 levels, not {levels}")
        kernel: Kernel = cls(support, scale)
        for level in range(1, levels):
            kernel = kernel + cls(support / 2**level, scale / 2**level)
        return kernel

    def block(self, x: Floats, y: Floats) -> Floats:
        """(n, m) products over the axes."""
        return np.asarray(self.scale**2 * np.prod([self._axis(x, y, axis, 0) for axis in range(3)], axis=0))

    def slopes(self, x: Floats, y: Floats) -> Floats:
        values = [self._axis(x, y, axis, 0) for axis in range(3)]
        slopes = [self._axis(x, y, axis, 1) / self._spacing for axis in range(3)]
        terms = [
            slopes[0] * values[1] * values[2],
            values[0] * slopes[1] * values[2],
            values[0] * values[1] * slopes[2],
        ]
        return self.scale**2 * np.stack(terms, axis=-1)

    def diagonal(self, x: Floats) -> Floats:
        """(n,) between 0.79 scale² and scale²."""
        result = np.full(len(x), float(self.scale**2))
        for axis in range(3):
            result *= 2 * np.square(_splines(x[:, axis] / self._spacing, 0)[1]).sum(axis=1)
        return result

    @property
    def _spacing(self) -> float:
        return self.support / 4

    def _axis(self, x: Floats, y: Floats, axis: int, derivative: int) -> Floats:
        """(n, m) one factor: sums over the lattice planes that y reaches; those of x elsewhere meet nothing."""
        planes_x, values_x = _splines(x[:, axis] / self._spacing, derivative)
        planes_y, values_y = _splines(y[:, axis] / self._spacing, 0)
        planes = np.unique(planes_y)
        return 2 * _spread(planes_x, values_x, planes) @ _spread(planes_y, values_y, planes).T


def _splines(t: Floats, derivative: int) -> tuple[NDArray[np.int64], Floats]:
    """(n, 4) the planes whose cubic B-spline is not zero at t, and its values there, or their derivatives by t."""
    first = np.floor(t)
    u = t - first
    v = 1 - u
    if derivative:
        values = [-v * v / 2, u * (1.5 * u - 2), v * (2 - 1.5 * v), u * u / 2]
    else:
        values = [v**3 / 6, 2 / 3 + u * u * (u / 2 - 1), 2 / 3 + v * v * (v / 2 - 1), u**3 / 6]
    return first.astype(np.int64)[:, None] + np.arange(-1, 3), np.stack(values, axis=1)


def _spread(planes: NDArray[np.int64], values: Floats, chosen: NDArray[np.int64]) -> Floats:
    """(n, len(chosen)) the values in the columns of their planes."""
    result = np.zeros((len(planes), len(chosen)))
    if not len(chosen):
        return result
    column = np.minimum(np.searchsorted(chosen, planes), len(chosen) - 1)
    row, which = np.nonzero(chosen[column] == planes)
    result[row, column[row, which]] = values[row, which]
    return result
