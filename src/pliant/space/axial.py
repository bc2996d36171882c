"""What Barr's global deformations share: an axis, an origin, bounds along the axis, and a few numbers to turn.

Barr, "Global and local deformations of solid primitives" (1984). Each of them carries the sections of space by affine
maps (:mod:`pliant.numerics.maps.sections`), so that a deformer only says which.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import (
    Controls,
    SpaceDeformer,
    Target,
    checked_controls,
    require_finite,
)
from pliant.errors import InvalidControls, InvalidDeformer
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.numerics.maps.sections import Entries, displaced, jacobians, section_of
from pliant.numerics.ragged import frozen
from pliant.space.affine import Axis
from pliant.space.axes import extent_along, one_number, three_numbers, unit_axis
from pliant.space.axial_binding import AxialBinding

Floats = NDArray[np.float64]
Numbers = NDArray[Any]

_STEP = 1e-30  # of the imaginary part: its square is lost beside any number, so that derivatives are exact


@dataclass(frozen=True, eq=False, kw_only=True)
class AxialDeformer(SpaceDeformer):
    """A deformation along an axis, controlled by a few numbers.

    Parameters
    ----------
    axis
        ``"x"``, ``"y"``, ``"z"`` or (3,), of any length.
    origin
        (3,) a point that the axis passes.
    bounds
        Between which positions along the axis (x . axis, from the world's origin) the deformation changes; beyond
        them it continues as it is at the bound.

    Raises
    ------
    InvalidDeformer
        An axis without direction, bounds that are reversed, numbers that are not finite.
    """

    axis: Axis = "z"
    origin: ArrayLike = (0.0, 0.0, 0.0)
    bounds: tuple[float, float] = (0.0, 1.0)

    parameters: ClassVar[tuple[str, ...]] = ()
    """Names of the fields that are the deformer's controls, in order."""
    neutral: ClassVar[Mapping[str, float]] = MappingProxyType({})
    """The parameters at rest; those not named rest where they are."""
    radial: ClassVar[bool] = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "origin", frozen(three_numbers("origin", self.origin), np.float64))
        if not isinstance(self.axis, str):
            object.__setattr__(self, "axis", frozen(three_numbers("axis", self.axis), np.float64))
        unit_axis(self.axis)
        object.__setattr__(self, "bounds", _checked_bounds(self.bounds))
        for name in self.parameters:
            object.__setattr__(self, name, one_number(name, getattr(self, name)))

    @classmethod
    def around(cls, target: PolygonMesh | ArrayLike, **fields: Any) -> Self:
        """Laid around a shape: origin and bounds are taken from it, where they are not among ``fields``.

        Parameters
        ----------
        target
            A mesh or (n, 3) points.
        fields
            As for the class itself: axis, parameters and so on.
        """
        low, high = extent_along(target, np.eye(3))
        fields.setdefault("origin", (low + high) / 2)
        fields.setdefault("bounds", cls(**{**fields, "bounds": (0.0, 1.0)})._extent(target))
        return cls(**fields)

    @property
    def rest(self) -> Controls:
        """(p,) the parameters at which nothing moves."""
        return np.array([self.neutral.get(name, getattr(self, name)) for name in self.parameters])

    @property
    def controls(self) -> Controls:
        """(p,) the parameters, in the order of :attr:`parameters`."""
        return np.array([getattr(self, name) for name in self.parameters])

    def moved(self, controls: ArrayLike) -> Self:
        """The deformer with (p,) other parameters.

        Raises
        ------
        InvalidControls
            Another shape, or values that the deformer cannot have.
        """
        values = checked_controls(controls, (len(self.parameters),))
        try:
            return replace(self, **dict(zip(self.parameters, values.tolist(), strict=True)))
        except InvalidDeformer as error:
            raise InvalidControls(str(error)) from error

    def bind(self, target: Target) -> AxialBinding:
        """Keep the target's points: there is nothing else to prepare."""
        return AxialBinding(self, as_points(target))

    def jacobian(self, points: ArrayLike) -> Floats:
        return jacobians(as_points(points, borrow=True), self._frame, self._entries, self._slopes, self.radial)

    @property
    def frame(self) -> Floats:
        """(3, 4) maps positions to (u, v, s): across the axis from the origin; along it, as bounds are measured."""
        return self._frame

    @abstractmethod
    def _table(self, q: Floats, numbers: Numbers) -> Entries:
        """The displacement of the sections q, see :mod:`pliant.numerics.maps.sections`, for (p,) numbers.

        The numbers may be complex: derivatives by them are taken along the imaginary axis.
        """

    @abstractmethod
    def _slopes(self, q: Floats) -> Entries:
        """The derivatives of the table by q."""

    def _entries(self, q: Floats) -> Entries:
        return self._table(q, self.controls)

    @cached_property
    def _frame(self) -> Floats:
        """(3, 4) maps positions to (u, v, s): across the axis from the origin, along it from the world's origin."""
        along = unit_axis(self.axis)
        across = np.eye(3)[np.argmin(np.abs(along))]
        return self._frame_across(across, along)

    def _frame_across(self, across: Floats, along: Floats) -> Floats:
        """The frame whose first coordinate is measured along ``across``, less what that has along the axis."""
        length = float(np.linalg.norm(along))
        along = along / (length or 1.0)
        first = across - (across @ along) * along
        if length < 1e-9 or np.linalg.norm(first) < 1e-9:
            raise InvalidDeformer("the normal is parallel to the axis: pass one that stands across it")
        first = first / np.linalg.norm(first)
        rows = np.stack([first, np.cross(along, first), along])
        offset = -rows @ np.asarray(self.origin)
        return np.column_stack([rows, [offset[0], offset[1], 0.0]])

    def _extent(self, target: PolygonMesh | ArrayLike) -> tuple[float, float]:
        """The bounds that hold a shape."""
        low, high = extent_along(target, np.column_stack([self._frame[2, :3], np.eye(3)]))
        size = float(np.linalg.norm(high[1:] - low[1:])) or 1.0
        flat = high[0] - low[0] <= 1e-12 * max(size, abs(low[0]))
        return float(low[0] - size / 2 * flat), float(high[0] + size / 2 * flat)

    @property
    def _width(self) -> float:
        return self.bounds[1] - self.bounds[0]

    def _clamped(self, q: Floats) -> Floats:
        """Positions in units of the bounds: 0 below, 1 above."""
        t = q - self.bounds[0]
        t /= self._width
        return np.clip(t, 0.0, 1.0, out=t)

    def _between(self, q: Floats) -> NDArray[np.bool_]:
        return (q >= self.bounds[0]) & (q <= self.bounds[1])

    def _deformed(self, target: Target) -> Points:
        points = as_points(target, borrow=True)
        out = np.empty_like(points)
        return self._moved_into(points, out)

    def _moved_into(self, points: Points, out: Points) -> Points:
        """The deformed points, written to out, all finite."""
        return out if self._move(points, out) else require_finite(out, type(self).__name__)

    def _move(self, points: Points, out: Points) -> bool:
        """Write the deformed points to out, and tell whether all are finite."""
        return displaced(points, self._frame, self._entries, points, out, self.radial)

    def _change(self, points: Points, numbers: Controls, change: Controls) -> Points:
        """(n, 3) how the points move when the numbers change: a complex step, exact to rounding."""
        out, ahead = np.empty_like(points), numbers + 1j * _STEP * change

        def entries(q: Floats) -> Entries:
            return {place: np.imag(values) / _STEP for place, values in self._table(q, ahead).items()}

        displaced(points, self._frame, entries, np.zeros_like(points), out, self.radial)
        return out

    def _undone(self, points: ArrayLike, entries: Any) -> Points:
        """The images of points under other entries in the same frame."""
        images = as_points(points, borrow=True)
        out = np.empty_like(images)
        finite = displaced(images, self._frame, entries, images, out, self.radial)
        return out if finite else require_finite(out, f"inverse of {type(self).__name__}")

    def _sections(self, points: Points) -> Floats:
        return section_of(points, self._frame, self.radial)


def _checked_bounds(bounds: Any) -> tuple[float, float]:
    try:
        low, high = (float(value) for value in bounds)
    except (TypeError, ValueError) as error:
        raise InvalidDeformer(f"bounds are {bounds!r}; two numbers are needed, low and high") from error
    if not (np.isfinite(low) and np.isfinite(high)):
        raise InvalidDeformer(f"bounds ({low:g}, {high:g}) must be finite")
    if low >= high:
        raise InvalidDeformer(f"bounds ({low:g}, {high:g}) are reversed or empty: pass the lower one first")
    return low, high
