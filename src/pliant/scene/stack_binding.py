"""A stack bound to a shape: what each layer made of it, and what a change leaves valid."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from pliant.deformer import Binding, Controls, Target, checked_controls, checked_out
from pliant.errors import InvalidTarget
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.scene.cache import Cache
from pliant.scene.keys import array_key
from pliant.scene.layer import Layer
from pliant.scene.layer_controls import flat, parts
from pliant.scene.stack_chain import StackChain
from pliant.scene.stack_step import Evaluator, Ground, Step, controls_of

if TYPE_CHECKING:
    from pliant.scene.stack import Stack
    from pliant.scene.stack_drag import LayerDrag


class StackBinding(Binding):
    """A stack, evaluated on a shape. Immutable; what it has computed is shared with the bindings made from it.

    Results are known by the content that they depend on. After a change in one layer, that layer and those above it
    are evaluated; those below, and a layer whose controls move, are not bound again. What was muted, moved or undone
    is still known, as long as there is room for it.

    Parameters
    ----------
    stack
        The layers.
    target
        The shape at rest.
    base
        (n, 3) where its points are before the first layer, as in an animation; None = at rest.
    cache
        Of earlier results on the same shape.
    exact
        Whether what was supposed of layers does not count.
    """

    def __init__(
        self,
        stack: Stack,
        target: Target,
        base: ArrayLike | None = None,
        cache: Cache | None = None,
        exact: bool = False,
    ) -> None:
        self.stack = stack
        self.target: Target = target if isinstance(target, PolygonMesh) else as_points(target)
        rest = as_points(self.target)
        points = rest if base is None else as_points(base)
        if points.shape != rest.shape:
            raise InvalidTarget(f"the base has {len(points):,} points; the shape at rest has {len(rest):,}")
        self._cache = Cache() if cache is None else cache
        key = b"rest" if base is None else array_key(points)
        self._ground = Ground(self.target, points, key, base is not None)
        self._evaluator = Evaluator(self._ground, self._cache, stack.mode == "add", exact)
        self._steps: dict[str, Step] = {}
        for layer in stack.active:
            step = self._evaluator.step(layer, points, key)
            self._steps[layer.name] = step
            points, key = step.points, step.key
        self._result = points

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.stack, self.target, self._ground.base if self._ground.moved else None)

    def updated(self, stack: Stack, base: ArrayLike | None = None) -> StackBinding:
        """Another stack on the same shape: only what has changed is computed.

        Parameters
        ----------
        stack
            The layers.
        base
            (n, 3) where the points are before the first layer; None = where they are in this binding.
        """
        if base is None and self._ground.moved:
            base = self._ground.base
        return StackBinding(stack, self.target, base, self._cache)

    def suppose(self, layer: Layer, image: Points) -> None:
        """Let points stand for what an edit of the surface does, in all bindings that share what is known.

        An iteration that a drag has not ended is near its end: so it can be shown at once, and :meth:`settled` later.

        Parameters
        ----------
        layer
            The layer, as it will be.
        image
            (n, 3) where its deformer puts the shape at rest, nearly.
        """
        self._evaluator.suppose(layer, image)

    def settled(self) -> StackBinding:
        """The same with nothing supposed; from then on that is what is known."""
        base = self._ground.base if self._ground.moved else None
        found = StackBinding(self.stack, self.target, base, self._cache, exact=True)
        for layer in self.stack.active:
            if self._evaluator.near(layer) is not None:
                self._evaluator.suppose(layer, None)
        return found

    def image(self, name: str) -> Points:
        """(n, 3) where a layer's deformer alone puts what it deforms, a copy; as far as that is known, if it is near.

        Raises
        ------
        InvalidParameter
            There is no such layer.
        """
        layer, bound = self.stack[name], self.bound(name)
        near, step = self._evaluator.near(layer), self._steps.get(name)
        if near is not None:
            return near.copy()
        if step is not None and step.at is step.below and np.all(layer.strength == 1.0):
            return np.array(step.points)
        return bound.deform(controls_of(layer, bound))

    @property
    def result(self) -> Points:
        """(n, 3) the deformed points, read-only: no copy is made."""
        view = self._result.view()
        view.flags.writeable = False
        return view

    def below(self, name: str) -> Points:
        """(n, 3) what a layer is given, read-only; where it is left out, what it would be given.

        Raises
        ------
        InvalidParameter
            There is no such layer.
        """
        points = self._ground.base
        for layer in self.stack.layers[: self.stack.index(name)]:
            points = self._steps[layer.name].points if layer.name in self._steps else points
        return points

    def bound(self, name: str) -> Binding:
        """The binding of a layer's deformer, to the shape at rest or to what the layer is given.

        Raises
        ------
        InvalidParameter
            There is no such layer.
        """
        layer = self.stack[name]
        step = self._steps.get(name) or self._unheard(layer)
        return self._evaluator.binding(step)

    def has_bound(self, layer: Layer) -> bool:
        """Whether a layer that edits the surface, of this stack or of another on the same shape, is bound already."""
        return self._evaluator.has_bound(layer)

    def drag_layer(self, name: str, controls: ArrayLike | None = None) -> LayerDrag:
        """Begin to move the controls of one layer: only points that they reach travel through the layers above.

        Parameters
        ----------
        name
            The layer.
        controls
            Where its controls begin; None = where they are.

        Raises
        ------
        InvalidParameter
            There is no such layer.
        """
        from pliant.scene.stack_drag import LayerDrag

        start = self
        if controls is not None:
            moved = self.stack[name].deformer.moved(controls)
            start = self.updated(self.stack.replace(name, deformer=moved))
        return LayerDrag(start, name)

    @cached_property
    def _rests(self) -> list[Controls]:
        return [layer.deformer.rest if layer.in_space else self.bound(layer.name).rest for layer in self.stack.layers]

    @property
    def rest(self) -> Controls:
        """(p,) the rest controls of all layers."""
        return flat(self._rests)

    @cached_property
    def controls(self) -> Controls:
        """(p,) the controls of all layers."""
        return flat(
            layer.deformer.controls if layer.in_space else controls_of(layer, self.bound(layer.name))
            for layer in self.stack.layers
        )

    @property
    def points(self) -> Points:
        """(n, 3) the target's points, read-only."""
        return self._ground.base

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        result = checked_out(out, len(self._result))
        np.copyto(result, self._at(controls)._result)
        return result

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        """(n, 3) by the chain rule through maps of space.

        Raises
        ------
        NotDifferentiable
            A layer that edits a surface stands on others, or has no derivative itself.
        """
        changes = self._split(checked_controls(d_controls, self.rest.shape))
        return self._at(controls)._chain.push(changes, len(self._result))

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        """(p,) the transpose of :meth:`jvp`."""
        pulled = self._at(controls)._chain.pull(checked_controls(d_points, self._result.shape))
        names = zip(self.stack.names, self._rests, strict=True)
        return flat(pulled[name] if name in pulled else np.zeros_like(rest) for name, rest in names)

    @property
    def _chain(self) -> StackChain:
        return StackChain(self._steps.values(), self._evaluator, self.stack.mode == "compose", self._ground.moved)

    def _at(self, controls: ArrayLike | None) -> StackBinding:
        return self if controls is None else self.updated(self.stack.moved(controls))

    def _split(self, controls: Controls) -> dict[str, Controls]:
        shapes = [rest.shape for rest in self._rests]
        return dict(zip(self.stack.names, parts(controls, shapes), strict=True))

    def _unheard(self, layer: Layer) -> Step:
        """A layer that is left out, as if it were not."""
        below = self.below(layer.name)
        return self._evaluator.step(layer, below, array_key(below))
