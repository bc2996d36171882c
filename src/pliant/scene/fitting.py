"""Deformers made for one box, laid into another: what a stack or clip did to one shape is done to any.

Positions go with the box along each of its axes, lengths with its diagonal; angles, factors and directions stay. What
holds many positions, such as a lattice or a cage, is carried by the affine map between the boxes: A(T(A^-1 x)).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer, SpaceDeformer
from pliant.scene.fields import fields_of
from pliant.scene.motions import between
from pliant.scene.recipe_values import Box
from pliant.space.affine import Affine
from pliant.space.axes import unit_axis
from pliant.space.axial import AxialDeformer
from pliant.space.placed import Placed, place
from pliant.space.scale import Scale

Floats = NDArray[np.float64]


class Fit:
    """From one box to another.

    Parameters
    ----------
    before, after
        What deformers were made for, and what they are to fit.
    """

    def __init__(self, before: Box, after: Box) -> None:
        self._before, self._after = before, after
        self.growth = after.diagonal / before.diagonal
        old, new = before.high - before.low, after.high - after.low
        flat = (old <= 1e-9 * before.diagonal) | (new <= 1e-9 * after.diagonal)
        self._stretch = np.where(flat, self.growth, new / np.where(flat, 1.0, old))
        self.same = bool(np.array_equal(before.low, after.low) and np.array_equal(before.high, after.high))

    @property
    def map(self) -> Affine:
        """A, which takes the one box to the other."""
        matrix = np.diag([*self._stretch, 1.0])
        matrix[:3, 3] = self.place(np.zeros(3))
        return Affine(matrix)

    def deformer(self, deformer: Deformer) -> Deformer:
        """A deformer that does to the new box what the given one does to the old; an edit of a surface stays."""
        if self.same or not isinstance(deformer, SpaceDeformer):
            return deformer
        if isinstance(deformer, Affine):
            return Affine(self.motion(deformer.matrix), deformer.direction)
        if isinstance(deformer, AxialDeformer | Scale):
            names = [field.name for field in fields_of(type(deformer))]
            return replace(deformer, **{name: self.field(deformer, name, getattr(deformer, name)) for name in names})
        if isinstance(deformer, Placed):
            return place(deformer.deformer, self.frame(deformer.frame.matrix))
        return place(deformer, self.map)

    def field(self, deformer: Deformer, name: str, value: Any) -> Any:
        """A value of one of a deformer's fields, for the new box."""
        if self.same:
            return value
        if isinstance(deformer, Affine):
            return self.motion(np.asarray(value)) if name == "matrix" else value
        if name == "frame":
            carried = isinstance(deformer, Placed)
            return self.frame(value).matrix if carried else self.motion(value)
        if not isinstance(deformer, AxialDeformer | Scale):
            return value  # it is carried, and its fields are those of where it was
        if name == "controls":
            parts = zip(deformer.parameters, np.ravel(value).tolist(), strict=False)
            fitted = [self.field(deformer, each, part) for each, part in parts]
            return np.array(fitted) if len(fitted) == np.size(value) else value
        if name == "origin":
            return self.place(np.asarray(value, np.float64))
        if name == "bounds" or (name == "center" and value is not None):
            along = self._along(deformer)  # type: ignore[arg-type]  # a scale has neither
            return tuple(map(along, value)) if name == "bounds" else along(value)
        lengths = {field.name for field in fields_of(type(deformer)) if field.type == "length"}
        return value * self.growth if name in lengths else value

    def place(self, point: Floats) -> Floats:
        """(3,) where a position in the old box is in the new one."""
        return np.asarray(self._after.low + self._stretch * (point - self._before.low))

    def frame(self, matrix: Floats) -> Affine:
        """Where a tool that stood at a (4, 4) placement stands in the new box; it stretches with it."""
        return Affine(self.map.matrix @ matrix)

    def motion(self, matrix: Floats) -> Floats:
        """(4, 4) an affine motion of the shape: turned and scaled as before, about the same place of the box."""
        linear, foot = matrix[:3, :3], self._foot(self._before)
        new = self._foot(self._after)
        result = np.eye(4)
        result[:3, :3] = linear
        result[:3, 3] = new + self._stretch * (linear @ foot + matrix[:3, 3] - foot) - linear @ new
        return result

    def _along(self, deformer: AxialDeformer) -> Callable[[float], float]:
        """How positions along a deformer's axis, or distances from it, change."""
        axis = np.asarray(getattr(deformer, "along", unit_axis(deformer.axis)))
        if deformer.radial:
            across = np.sqrt(1 - axis**2)
            old, new = ((box.high - box.low) * across for box in (self._before, self._after))
            ratio = float(np.linalg.norm(new) / (np.linalg.norm(old) or 1.0))
            return lambda at: ratio * at
        (low, high), (to_low, to_high) = _ends(self._before, axis), _ends(self._after, axis)
        ratio = (to_high - to_low) / (high - low) if high > low and to_high > to_low else self.growth
        return lambda at: to_low + ratio * (at - low)

    @staticmethod
    def _foot(box: Box) -> Floats:
        """The middle of the box's floor, about which recipes turn."""
        return box.place(["50 %", "50 %", "0 %"])


def exaggerated(deformer: Deformer, intensity: float) -> Deformer:
    """A deformer that does so much of what it does: 0 nothing, 1 all; an edit of a surface stays.

    Parameters
    ----------
    deformer
        Not one whose class names parameters at rest: those are taken further one by one.
    intensity
        How far its controls are from rest.
    """
    if intensity == 1.0 or not isinstance(deformer, SpaceDeformer):
        return deformer
    if isinstance(deformer, Affine):
        return Affine(between(np.eye(4), deformer.matrix, intensity), deformer.direction)
    return deformer.moved(deformer.rest + intensity * (deformer.controls - deformer.rest))


def _ends(box: Box, axis: Floats) -> tuple[float, float]:
    """Between which positions along an axis a box lies."""
    ends = np.stack([box.low * axis, box.high * axis])
    return float(ends.min(axis=0).sum()), float(ends.max(axis=0).sum())
