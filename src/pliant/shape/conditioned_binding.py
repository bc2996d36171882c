"""Points bound to coefficients and landmarks: linear in both, x' = b + Q (z + K (p − x(z)))."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from pliant.deformer import Controls, LinearBinding, checked_controls, checked_out, require_finite
from pliant.mesh import Points
from pliant.shape.basis import Basis, Floats
from pliant.shape.correction import Correction


class ConditionedBinding(LinearBinding):
    """Points that move with (k,) coefficients, and with landmarks that correct them.

    Parameters
    ----------
    points
        (n, 3) the target's.
    base
        (n, 3) where they are at rest: at the mean.
    basis
        The fields at the points.
    correction
        What landmarks do to coefficients; None = there are none.
    landmarks
        (m, 3) where the mean has them.
    controls
        (k + 3 m,) the deformer's own.
    """

    def __init__(
        self,
        points: Points,
        base: Points,
        basis: Basis,
        correction: Correction | None,
        landmarks: Points,
        controls: Controls,
    ) -> None:
        self._points, self._base, self._basis, self._controls = points, base, basis, controls
        self._correction, self._landmarks = correction, landmarks

    @property
    def rest(self) -> Controls:
        return np.concatenate([np.zeros(self._basis.count), self._landmarks.reshape(-1)])

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        target = checked_out(out, len(self._points))
        away = self._checked(controls) - self.rest
        np.add(self._base, self._basis.apply(self._corrected(away)), out=target)
        return require_finite(target, "shape model")

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        change = checked_controls(d_controls, self._controls.shape)
        return np.asarray(self._basis.apply(self._corrected(change)), np.float64)

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        gradient = self._basis.transpose(checked_controls(d_points, self._points.shape))
        if self._correction is None:
            return gradient
        pulled = self._correction.gain_transposed(gradient)
        return np.concatenate([self._correction.transposed(gradient), pulled.reshape(-1)])

    def _corrected(self, away: Controls) -> Floats:
        """(k,) coefficients, from how far the controls are away from rest."""
        count = self._basis.count
        if self._correction is None:
            return away
        return self._correction(away[:count], away[count:].reshape(-1, 3))
