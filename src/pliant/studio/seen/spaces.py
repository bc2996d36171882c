"""The stack as a map of space: what grids, arrows and proofs are of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Controls, SpaceDeformer, Target
from pliant.errors import NotDifferentiable
from pliant.mesh import Points, as_points
from pliant.scene.stack import Stack
from pliant.scene.stack_binding import StackBinding
from pliant.space.affine import Affine


@dataclass(frozen=True, eq=False)
class _StackMap(SpaceDeformer):
    """Layers of a stack that are maps of space, one after another.

    Parameters
    ----------
    stack
        All of whose active layers are maps of space, without masks.
    """

    stack: Stack

    @property
    def rest(self) -> Controls:
        return self.stack.rest

    @property
    def controls(self) -> Controls:
        return self.stack.controls

    def moved(self, controls: ArrayLike) -> _StackMap:
        return _StackMap(self.stack.moved(controls))

    def bind(self, target: Target) -> StackBinding:
        return self.stack.bind(as_points(target))

    def _deformed(self, target: Target) -> Points:
        return self.stack._deformed(as_points(target))

    def jacobian(self, points: ArrayLike) -> NDArray[np.float64]:
        return self.stack.jacobian(points)


def space_map(stack: Stack) -> SpaceDeformer:
    """The map of space that the active layers are together; the layer's own deformer where there is one only.

    Raises
    ------
    NotDifferentiable
        A layer edits a surface, or is masked by vertices.
    """
    active = stack.active
    for layer in active:
        if not isinstance(layer.deformer, SpaceDeformer) or layer.mask is not None:
            why = "edits the surface" if not layer.in_space else "is masked by vertices"
            raise NotDifferentiable(f"layer {layer.name!r} {why}: it deforms no space around it (mute it to look on)")
    if not active:
        return Affine.translation([0.0, 0.0, 0.0])
    only = active[0]
    if len(active) == 1 and only.envelope == 1.0:
        assert isinstance(only.deformer, SpaceDeformer)
        return only.deformer
    return _StackMap(stack)
