"""One map after another: deformers composed are a deformer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Binding, Controls, SpaceDeformer, Target, checked_controls, checked_out
from pliant.errors import InvalidDeformer
from pliant.mesh import Points, as_points

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Composition(SpaceDeformer):
    """x' = T_k(... T_2(T_1(x))).

    Its controls are those of its deformers, flattened in C order and put one after another: (p,).

    Parameters
    ----------
    deformers
        Maps of space; the first is applied first.

    Raises
    ------
    InvalidDeformer
        None at all, or one that is no map of space.
    """

    deformers: tuple[SpaceDeformer, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "deformers", tuple(self.deformers))
        if not self.deformers:
            raise InvalidDeformer("there is nothing to compose: pass at least one deformer")
        for place, deformer in enumerate(self.deformers):
            if not isinstance(deformer, SpaceDeformer):
                raise InvalidDeformer(
                    f"deformer {place} is a {type(deformer).__name__}, which is no map of space: it deforms the mesh "
                    "that it is bound to; apply it before or after the others instead"
                )

    @property
    def rest(self) -> Controls:
        """(p,) all rest controls."""
        return np.concatenate([deformer.rest.reshape(-1) for deformer in self.deformers])

    @property
    def controls(self) -> Controls:
        """(p,) all controls."""
        return np.concatenate([deformer.controls.reshape(-1) for deformer in self.deformers])

    def moved(self, controls: ArrayLike) -> Self:
        """The same maps with (p,) other controls."""
        parts = split(controls, self.deformers)
        return type(self)(tuple(d.moved(part) for d, part in zip(self.deformers, parts, strict=True)))

    def bind(self, target: Target) -> CompositionBinding:
        """Bind each map to what those before it make of the target."""
        return CompositionBinding(self.deformers, as_points(target))

    def _deformed(self, target: Target) -> Points:
        points = as_points(target, borrow=True)
        for deformer in self.deformers:
            points = deformer._deformed(points)
        return points

    def jacobian(self, points: ArrayLike) -> Floats:
        here = as_points(points, borrow=True)
        product = self.deformers[0].jacobian(here)
        for before, deformer in pairwise(self.deformers):
            here = before._deformed(here)
            product = deformer.jacobian(here) @ product
        return product

    def inverse(self, points: ArrayLike, *, tolerance: float = 1e-10, iterations: int = 50) -> Points:
        """Where (n, 3) points came from: the inverses in reverse order."""
        here = as_points(points)
        for deformer in reversed(self.deformers):
            here = deformer.inverse(here, tolerance=tolerance, iterations=iterations)
        return here


class CompositionBinding(Binding):
    """Points bound to several maps, each to what those before it made of the points.

    As long as only later maps are moved, what earlier ones did is not done again.
    """

    def __init__(self, deformers: tuple[SpaceDeformer, ...], points: Points) -> None:
        self._deformers = deformers
        self._bindings: list[Binding] = []
        for deformer in deformers:
            self._bindings.append(deformer.bind(points))
            if len(self._bindings) < len(deformers):
                points = self._bindings[-1].deform()

    @property
    def rest(self) -> Controls:
        """(p,) all rest controls."""
        return np.concatenate([binding.rest.reshape(-1) for binding in self._bindings])

    @property
    def controls(self) -> Controls:
        """(p,) all controls when they were bound."""
        return np.concatenate([binding.controls.reshape(-1) for binding in self._bindings])

    @property
    def points(self) -> Points:
        """(n, 3) the target's points, read-only."""
        return self._bindings[0].points

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        """(n, 3) the points after the last map."""
        result = checked_out(out, len(self.points))
        parts = self._parts(controls)
        first = self._first_moved(parts)
        here = self._bindings[first].deform(parts[first])
        for deformer, part in zip(self._deformers[first + 1 :], parts[first + 1 :], strict=True):
            here = deformer.moved(part)._deformed(here)
        result[:] = here
        return result

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        """(n, 3) by the chain rule: each map's own change, carried on by the Jacobians of those after it."""
        chain = self._chain(controls)
        changes = split(checked_controls(d_controls, self.rest.shape), self._deformers)
        moved = np.zeros_like(self.points)
        for (deformer, binding), change in zip(chain, changes, strict=True):
            carried = np.einsum("nij,nj->ni", deformer.jacobian(binding.points), moved)
            moved = carried + binding.jvp(None, change)
        return moved

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        """(p,) the transpose of :meth:`jvp`."""
        gradient = checked_controls(d_points, self.points.shape)
        pulled = []
        for deformer, binding in reversed(self._chain(controls)):
            pulled.append(binding.vjp(None, gradient).reshape(-1))
            gradient = np.einsum("nji,nj->ni", deformer.jacobian(binding.points), gradient)
        return np.concatenate(pulled[::-1])

    def _parts(self, controls: ArrayLike | None) -> list[Controls]:
        return split(self._checked(controls), self._deformers)

    def _first_moved(self, parts: Sequence[Controls]) -> int:
        """The first map whose controls are not those it was bound with; the last one at the latest."""
        for place, (binding, part) in enumerate(zip(self._bindings, parts, strict=True)):
            if not np.array_equal(binding.controls, part):
                return place
        return len(parts) - 1

    def _chain(self, controls: ArrayLike | None) -> list[tuple[SpaceDeformer, Binding]]:
        """Each map with some controls, bound to what those before it make of the points."""
        points, chain = self.points, []
        for deformer, part in zip(self._deformers, self._parts(controls), strict=True):
            moved = deformer.moved(part)
            chain.append((moved, moved.bind(points)))
            points = chain[-1][1].deform()
        return chain


def compose(*deformers: SpaceDeformer) -> Composition:
    """The deformers one after another, the first first: a map of space with a Jacobian and an inverse.

    Compositions among them are taken apart. With one of two deformers at rest it is the other, exactly.

    Raises
    ------
    InvalidDeformer
        None at all, or one that is no map of space.
    """
    flat: list[SpaceDeformer] = []
    for deformer in deformers:
        flat += deformer.deformers if isinstance(deformer, Composition) else (deformer,)
    return Composition(tuple(flat))


def split(controls: ArrayLike, deformers: Sequence[SpaceDeformer]) -> list[Controls]:
    """The controls of each deformer, in its own shape, from (p,) controls of all."""
    shapes = [deformer.rest.shape for deformer in deformers]
    sizes = [int(np.prod(shape)) for shape in shapes]
    flat = checked_controls(controls, (sum(sizes),))
    return [part.reshape(shape) for part, shape in zip(np.split(flat, np.cumsum(sizes)[:-1]), shapes, strict=True)]
