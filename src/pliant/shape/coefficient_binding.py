"""Points bound to the coefficients of fields: linear, x' = b + sum_j a_j ψ_j(x)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from pliant.deformer import Controls, LinearBinding, checked_controls, checked_out, require_finite
from pliant.mesh import Points
from pliant.shape.basis import Basis


class CoefficientBinding(LinearBinding):
    """Points that move with (k,) coefficients.

    Parameters
    ----------
    points
        (n, 3) the target's.
    base
        (n, 3) where they are while all coefficients are zero.
    basis
        The fields at the points.
    controls
        (k,) the deformer's own coefficients.
    """

    def __init__(self, points: Points, base: Points, basis: Basis, controls: Controls) -> None:
        self._points, self._base, self._basis, self._controls = points, base, basis, controls

    @property
    def rest(self) -> Controls:
        """(k,) zeros: the mean."""
        return np.zeros(self._basis.count)

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        target = checked_out(out, len(self._points))
        np.add(self._base, self._basis.apply(self._checked(controls)), out=target)
        return require_finite(target, "shape model")

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        return np.asarray(self._basis.apply(checked_controls(d_controls, self._controls.shape)), np.float64)

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        return self._basis.transpose(checked_controls(d_points, self._points.shape))
