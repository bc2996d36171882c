"""The inverse of a map of R^3 as a deformer of its own: for files whose direction is the other one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Binding, Controls, SpaceDeformer, Target, checked_controls, checked_out
from pliant.mesh import Points, as_points


@dataclass(frozen=True, eq=False)
class Inverse(SpaceDeformer):
    """x' = T^-1(x), solved point by point.

    Its controls are those of the deformer that it inverts. Deforming raises
    :class:`~pliant.errors.NotConverged` where that deformer folds.

    Parameters
    ----------
    deformer
        The map T.
    """

    deformer: SpaceDeformer

    @property
    def rest(self) -> Controls:
        """The controls at which the inverted deformer rests."""
        return self.deformer.rest

    @property
    def controls(self) -> Controls:
        """The controls of the inverted deformer."""
        return self.deformer.controls

    def moved(self, controls: ArrayLike) -> Self:
        """The inverse of the deformer with other controls."""
        return type(self)(self.deformer.moved(controls))

    def bind(self, target: Target) -> InverseBinding:
        """Keep the target's points: every move of the controls is solved anew."""
        return InverseBinding(self.deformer, as_points(target))

    def jacobian(self, points: ArrayLike) -> NDArray[np.float64]:
        """(n, 3, 3) the inverse of T's Jacobian at the pre-images."""
        forward = self.deformer.jacobian(self.deformer.inverse(points))
        return np.asarray(np.linalg.inv(forward), np.float64)

    def inverse(self, points: ArrayLike, *, tolerance: float = 1e-10, iterations: int = 50) -> Points:
        """T itself: nothing has to be solved."""
        return self.deformer(as_points(points))


class InverseBinding(Binding):
    """Points bound to the inverse of a deformer."""

    def __init__(self, deformer: SpaceDeformer, points: Points) -> None:
        self._deformer, self._points = deformer, points

    @property
    def rest(self) -> Controls:
        """The rest controls."""
        return self._deformer.rest

    @property
    def controls(self) -> Controls:
        """The controls of the inverted deformer."""
        return self._deformer.controls

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        """(n, 3) the pre-images."""
        result = checked_out(out, len(self._points))
        result[:] = self._at(controls).inverse(self._points)
        return result

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        """(n, 3) from T(c, x) = y with y fixed: dx = -J^-1 dT."""
        deformer, pre_images = self._solved(controls)
        moved = deformer.bind(pre_images).jvp(None, d_controls)
        return -_solve(deformer.jacobian(pre_images), moved)

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        """The transpose of :meth:`jvp`."""
        deformer, pre_images = self._solved(controls)
        gradient = checked_controls(d_points, self._points.shape)
        pulled = _solve(deformer.jacobian(pre_images).transpose(0, 2, 1), gradient)
        return deformer.bind(pre_images).vjp(None, -pulled)

    def _at(self, controls: ArrayLike | None) -> SpaceDeformer:
        return self._deformer if controls is None else self._deformer.moved(self._checked(controls))

    def _solved(self, controls: ArrayLike | None) -> tuple[SpaceDeformer, Points]:
        deformer = self._at(controls)
        return deformer, deformer.inverse(self._points)


def _solve(matrices: NDArray[np.float64], vectors: Points) -> Points:
    """(n, 3) solutions of n systems of three equations."""
    return np.asarray(np.linalg.solve(matrices, vectors[..., None])[..., 0], np.float64)
