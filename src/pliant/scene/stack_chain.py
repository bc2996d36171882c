"""Derivatives of a stack: the chain rule through its active steps."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Controls, SpaceDeformer
from pliant.errors import NotDifferentiable
from pliant.mesh import Points
from pliant.scene.layer import column
from pliant.scene.stack_step import Evaluator, Step, controls_of

Floats = NDArray[np.float64]


class StackChain:
    """The active steps of a stack, the first first, as factors of the chain rule.

    Parameters
    ----------
    steps
        What each layer has made.
    evaluator
        Of the same binding: what binds the layers.
    composed
        Whether each layer deforms the result of those below.
    moved
        Whether the points below the first are not those at rest.

    Raises
    ------
    NotDifferentiable
        A layer that edits a surface stands on others.
    """

    def __init__(self, steps: Iterable[Step], evaluator: Evaluator, composed: bool, moved: bool) -> None:
        self._steps, self._evaluator, self._composed = tuple(steps), evaluator, composed
        for place, step in enumerate(self._steps):
            if composed and not step.layer.in_space and (place or moved):
                raise NotDifferentiable(
                    f"layer {step.layer.name!r} edits a surface that other layers have turned: it has no derivative; "
                    "move it to the bottom, or add the layers instead of composing them"
                )

    def push(self, changes: Mapping[str, Controls], count: int) -> Points:
        """(count, 3) how the points move when the controls of layers, by name, change."""
        moved = np.zeros((count, 3))
        for place, step in enumerate(self._steps):
            binding = self._evaluator.binding(step)
            own = binding.jvp(controls_of(step.layer, binding), changes[step.layer.name])
            if self._composed and place:
                own += np.einsum("nij,nj->ni", _jacobian(step), moved) - moved
            moved += column(step.layer.strength) * own
        return moved

    def pull(self, gradient: Points) -> dict[str, Controls]:
        """The transpose of :meth:`push`: what (n, 3) gradients are for the controls of the active layers, by name."""
        pulled = {}
        for place, step in reversed(list(enumerate(self._steps))):
            part, binding = column(step.layer.strength) * gradient, self._evaluator.binding(step)
            pulled[step.layer.name] = binding.vjp(controls_of(step.layer, binding), part)
            if self._composed and place:
                gradient = gradient - part + np.einsum("nji,nj->ni", _jacobian(step), part)
        return pulled


def _jacobian(step: Step) -> Floats:
    """(n, 3, 3) of a map of space, where it finds the points."""
    assert isinstance(step.layer.deformer, SpaceDeformer)
    return step.layer.deformer.jacobian(step.at)
