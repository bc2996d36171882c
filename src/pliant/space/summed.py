"""Several maps at once: their displacements added up, as multi-level registrations do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Binding, Controls, SpaceDeformer, Target, checked_out, require_finite
from pliant.errors import InvalidDeformer
from pliant.mesh import Points, as_points
from pliant.space.compose import split


@dataclass(frozen=True, eq=False)
class Summed(SpaceDeformer):
    """x' = x + the sum over i of (T_i(x) - x).

    Its controls are those of all its deformers, one after another, flat.

    Parameters
    ----------
    deformers
        The maps T_i; at least one.

    Raises
    ------
    InvalidDeformer
        No deformer.
    """

    deformers: tuple[SpaceDeformer, ...]

    def __post_init__(self) -> None:
        if not self.deformers:
            raise InvalidDeformer("a sum needs at least one deformer")
        object.__setattr__(self, "deformers", tuple(self.deformers))

    @property
    def rest(self) -> Controls:
        """(p,) the rest controls of all deformers."""
        return _flat([deformer.rest for deformer in self.deformers])

    @property
    def controls(self) -> Controls:
        """(p,) the controls of all deformers."""
        return _flat([deformer.controls for deformer in self.deformers])

    def moved(self, controls: ArrayLike) -> Self:
        """The sum of the same deformers with (p,) other controls."""
        pieces = split(controls, self.deformers)
        return type(self)(tuple(each.moved(piece) for each, piece in zip(self.deformers, pieces, strict=True)))

    def bind(self, target: Target) -> SummedBinding:
        """Bind every deformer to the target."""
        points = as_points(target)
        return SummedBinding(self.deformers, points)

    def jacobian(self, points: ArrayLike) -> NDArray[np.float64]:
        """(n, 3, 3) I + the sum of (J_i - I)."""
        points = as_points(points)
        total = np.tile(np.eye(3), (len(points), 1, 1))
        for deformer in self.deformers:
            total += deformer.jacobian(points) - np.eye(3)
        return total


class SummedBinding(Binding):
    """Points bound to every deformer of a sum."""

    def __init__(self, deformers: tuple[SpaceDeformer, ...], points: Points) -> None:
        self._deformers, self._points = deformers, points
        self._parts = [deformer.bind(points) for deformer in deformers]

    @property
    def rest(self) -> Controls:
        """(p,) the rest controls of all deformers."""
        return _flat([part.rest for part in self._parts])

    @property
    def controls(self) -> Controls:
        """(p,) the controls of all deformers when they were bound."""
        return _flat([part.controls for part in self._parts])

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        """(n, 3) the points, moved by all displacements."""
        result = checked_out(out, len(self._points))
        result[:] = self._points
        for part, piece in zip(self._parts, self._split(controls), strict=True):
            result += part.deform(piece) - self._points
        return require_finite(result, "sum of deformers")

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        """(n, 3) the sum of the deformers' changes."""
        changes = split(d_controls, self._deformers)
        total = np.zeros((len(self._points), 3))
        for part, piece, change in zip(self._parts, self._split(controls), changes, strict=True):
            total += part.jvp(piece, change)
        return total

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        """(p,) the transpose of :meth:`jvp`."""
        pairs = zip(self._parts, self._split(controls), strict=True)
        return _flat([part.vjp(piece, d_points) for part, piece in pairs])

    def _split(self, controls: ArrayLike | None) -> list[Controls]:
        return split(self._checked(controls), self._deformers)


def _flat(arrays: list[Controls]) -> Controls:
    return np.concatenate([array.reshape(-1) for array in arrays])
