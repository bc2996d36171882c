"""A deformation carried elsewhere: the tool moves, turns or grows over the object.

Coquillart & Jancène, "Animated free-form deformation" (1991): x' = A(T(A^-1 x)).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Binding, Controls, SpaceDeformer, Target, checked_controls, checked_out, require_finite
from pliant.errors import InvalidDeformer
from pliant.mesh import Points, as_points
from pliant.space.affine import Affine

SAME = 1e-13  # a movement of the object seen from its tool, relative to its coordinates, that is rounding


@dataclass(frozen=True, eq=False)
class Placed(SpaceDeformer):
    """A deformer in a frame of its own.

    Its controls are those of the deformer, in the deformer's own frame.

    Parameters
    ----------
    deformer
        The map T.
    frame
        The affine map A from the deformer's frame to the world; not singular.
    """

    deformer: SpaceDeformer
    frame: Affine

    def __post_init__(self) -> None:
        if not isinstance(self.deformer, SpaceDeformer):
            raise InvalidDeformer(
                f"a {type(self.deformer).__name__} is no map of space: it deforms the mesh that it is bound to, "
                "wherever that is; only maps of space can be placed"
            )
        if not isinstance(self.frame, Affine):
            raise InvalidDeformer(f"a frame is an Affine, not a {type(self.frame).__name__}: pass Affine(matrix)")

    @property
    def rest(self) -> Controls:
        """The controls at which the deformer rests."""
        return self.deformer.rest

    @property
    def controls(self) -> Controls:
        """The deformer's controls."""
        return self.deformer.controls

    def moved(self, controls: ArrayLike) -> Self:
        """The deformer with other controls, in the same frame."""
        return type(self)(self.deformer.moved(controls), self.frame)

    def at(self, frame: Affine) -> Self:
        """The same tool elsewhere: to be moved over the object, frame by frame."""
        return type(self)(self.deformer, frame)

    def bind(self, target: Target) -> PlacedBinding:
        """Bind the deformer to the target seen from its frame."""
        return PlacedBinding.of(self.deformer, self.frame, as_points(target))

    def jacobian(self, points: ArrayLike) -> NDArray[np.float64]:
        """(n, 3, 3) A J A^-1, with J at the points seen from the frame."""
        inner = self.deformer.jacobian(self.frame.inverse(points))
        return np.asarray(self.frame.linear @ inner @ self.frame.inverted().linear, np.float64)

    def inverse(self, points: ArrayLike, *, tolerance: float = 1e-10, iterations: int = 50) -> Points:
        """Where (n, 3) points came from, solved in the deformer's own frame."""
        inner = self.deformer.inverse(self.frame.inverse(points), tolerance=tolerance, iterations=iterations)
        return self.frame(inner)


class PlacedBinding(Binding):
    """A binding in a frame of its own."""

    def __init__(self, inner: Binding, frame: Affine, points: Points, deformer: SpaceDeformer) -> None:
        self._inner, self._frame, self._points, self._deformer = inner, frame, points, deformer

    @classmethod
    def of(cls, deformer: SpaceDeformer, frame: Affine, points: Points) -> Self:
        """A deformer in a frame, bound to (n, 3) points of the world."""
        return cls(deformer.bind(frame.inverse(points)), frame, points, deformer)

    def at(self, frame: Affine, target: Target | None = None) -> PlacedBinding:
        """The tool in another frame, or over a target that has moved.

        Where tool and object have moved together, as rigid bodies tied to one another do, what the binding has done
        holds: only a placement of the tool relative to the object that is new is bound anew.

        Parameters
        ----------
        frame
            The affine map from the deformer's frame to the world, now.
        target
            The object, now; None = where it was.
        """
        points = self._points if target is None else as_points(target)
        seen = frame.inverse(points)
        before = self._inner.points
        if seen.shape == before.shape:
            size = float(np.abs(before).max(initial=1e-300))
            if np.abs(seen - before).max(initial=0.0) <= SAME * size:
                return PlacedBinding(self._inner, frame, points, self._deformer)
        return PlacedBinding(self._deformer.bind(seen), frame, points, self._deformer)

    @property
    def rest(self) -> Controls:
        """The rest controls."""
        return self._inner.rest

    @property
    def controls(self) -> Controls:
        """The controls of the deformer when it was bound."""
        return self._inner.controls

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        """(n, 3) the deformed points: the target plus what the deformer adds, so that rest stays exact."""
        result = checked_out(out, len(self._points))
        displacement = self._inner.deform(controls) - self._inner.points
        result[:] = self._points + displacement @ self._frame.linear.T
        return require_finite(result, "placed deformer")

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        """(n, 3) the deformer's change, turned into the world."""
        change: Points = self._inner.jvp(controls, d_controls) @ self._frame.linear.T
        return change

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        """The transpose of :meth:`jvp`."""
        gradient = checked_controls(d_points, self._points.shape)
        return self._inner.vjp(controls, gradient @ self._frame.linear)


def place(deformer: SpaceDeformer, frame: Affine) -> Placed:
    """The deformer, moved over the object by an affine map.

    The tool moves over the object: ``place(tool, frame)(mesh)``, with another frame at each moment. The object moves
    through the tool: ``place(tool, frame)(frame(mesh))`` is the deformed mesh, carried; bound once, as
    ``binding.at(frame, frame(mesh))``, it is not bound again.

    Parameters
    ----------
    deformer
        The map T.
    frame
        The affine map A from the deformer's frame to the world; not singular.
    """
    return Placed(deformer, frame)
