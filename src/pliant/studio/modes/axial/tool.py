"""A deformer along an axis as something to hold: its frame, its size, and how it is seen through the layers above.

One that was placed elsewhere is held in its own frame; where it stands comes before the layers above.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer, SpaceDeformer
from pliant.mesh import Points
from pliant.scene.keyed import tool_of
from pliant.scene.layer import Layer
from pliant.scene.stack import Stack
from pliant.space.axial import AxialDeformer
from pliant.space.placed import Placed, place
from pliant.space.scale import Scale
from pliant.studio.modes.placements import to_world

Floats = NDArray[np.float64]
_ROOM = 1.08  # around the shape, so that handles stand clear of it


@dataclass(frozen=True, eq=False)
class Tool:
    """A deformer that is held.

    Parameters
    ----------
    deformer
        An axial deformer, or a scale.
    size
        How far handles stand from the axis.
    envelope
        How much of it there is.
    above
        Where (n, 3) points of the deformer's frame are seen: where it is placed, and behind the layers above.
    """

    deformer: Any
    size: float
    envelope: float = 1.0
    above: Callable[[Points], Points] = lambda points: points

    def having(self, **fields: Any) -> Tool:
        """The same tool with other fields of its deformer."""
        return replace(self, deformer=replace(self.deformer, **fields))

    @property
    def origin(self) -> Floats:
        """(3,) the deformer's origin."""
        return np.asarray(self.deformer.origin)

    @property
    def axes(self) -> Floats:
        """(3, 3) unit columns: two across the axis, one along it."""
        deformer = self.deformer
        return np.asarray(deformer.axes) if isinstance(deformer, Scale) else deformer.frame[:, :3].T

    @property
    def along(self) -> Floats:
        """(3,) the direction in which sections follow one another."""
        return self.axes[:, 2]

    def at(self, u: Any, v: Any, s: Any) -> Points:
        """(n, 3) places: u and v sizes across the axis, s along it, measured as bounds are."""
        first, second, along = self.axes.T
        u, v, s = np.broadcast_arrays(np.float64(u), np.float64(v), np.float64(s))
        across = self.size * (u[..., None] * first + v[..., None] * second)
        return np.asarray(self.origin + across + (s[..., None] - self.origin @ along) * along)

    def between(self, t: Any) -> Any:
        """Positions along the axis: 0 at the low bound, 1 at the high one."""
        low, high = self.deformer.bounds
        return low + np.asarray(t) * (high - low)

    def carried(self, points: Points) -> Points:
        """(n, 3) where the deformer, and all above it, take points."""
        return self.above(points + self.envelope * (self.deformer(points) - points))


def holds(deformer: Deformer) -> bool:
    """Whether there are handles for a deformer, wherever it is placed."""
    return isinstance(tool_of(deformer), AxialDeformer | Scale)


def tool_on(stack: Stack, layer: str, below: Points) -> Tool:
    """The tool of a layer, as large as the shape that it is given is wide; placing it takes its size along."""
    found = stack[layer]
    deformer = tool_of(found.deformer)
    return Tool(deformer, size_of(deformer, below), found.envelope, _seen(stack, layer))


def exchanged(layer: Layer, deformer: SpaceDeformer) -> SpaceDeformer:
    """Another deformer for a layer, placed where its own is."""
    return place(deformer, layer.deformer.frame) if isinstance(layer.deformer, Placed) else deformer


def size_of(deformer: Any, points: Points) -> float:
    """How far a shape reaches from the deformer's axis, or from its origin, and a little more."""
    offsets = points - np.asarray(deformer.origin)
    if isinstance(deformer, AxialDeformer) and not deformer.radial:
        offsets = offsets @ deformer.frame[:2, :3].T
    reach = float(np.sqrt(np.einsum("ij,ij->i", offsets, offsets).max(initial=0.0)))
    return _ROOM * reach or 1.0


def _seen(stack: Stack, layer: str) -> Callable[[Points], Points]:
    """From the frame of a layer's deformer to the world, and on through the layers above."""
    deformer, above = stack[layer].deformer, _above(stack, layer)
    return lambda points: above(to_world(deformer, points))


def _above(stack: Stack, layer: str) -> Callable[[Points], Points]:
    """The map that the active layers after one are; nothing where they are no map of space."""
    later = stack.layers[stack.index(layer) + 1 :]
    active = tuple(each for each in stack.active if each in later)
    plain = all(isinstance(each.deformer, SpaceDeformer) and each.mask is None for each in active)
    if not active or not plain or stack.mode != "compose":
        return lambda points: points
    return Stack(active)
