"""Points bound to a deformation along an axis, which a few numbers control."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from pliant.deformer import Binding, Controls, checked_controls, checked_out
from pliant.mesh import Points

if TYPE_CHECKING:
    from pliant.space.axial import AxialDeformer


class AxialBinding(Binding):
    """Points bound to a deformation along an axis."""

    def __init__(self, deformer: AxialDeformer, points: Points) -> None:
        self._deformer, self._points = deformer, points

    @property
    def rest(self) -> Controls:
        """(p,) the parameters at which nothing moves."""
        return self._deformer.rest

    @property
    def controls(self) -> Controls:
        """(p,) the deformer's parameters when it was bound."""
        return self._deformer.controls

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        """(n, 3) the deformed points."""
        return self._at(controls)._moved_into(self._points, checked_out(out, len(self._points)))

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        """(n, 3) how the points move when the parameters change."""
        change = checked_controls(d_controls, self.rest.shape)
        return self._deformer._change(self._points, self._checked(controls), change)

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        """(p,) the transpose of :meth:`jvp`."""
        gradient, numbers = checked_controls(d_points, self._points.shape), self._checked(controls)
        steps = np.eye(len(numbers))
        return np.array([np.vdot(self._deformer._change(self._points, numbers, step), gradient) for step in steps])

    def _at(self, controls: ArrayLike | None) -> AxialDeformer:
        return self._deformer if controls is None else self._deformer.moved(controls)
