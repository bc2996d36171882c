"""Bend: a piece of the axis becomes an arc (Barr 1984, section 3.4)."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import NotConverged, PliantWarning
from pliant.mesh import Points, as_points
from pliant.numerics.maps.sections import Entries, section_of
from pliant.space.affine import Axis
from pliant.space.axes import one_number, unit_axis
from pliant.space.axial import AxialDeformer, Numbers

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Bend(AxialDeformer):
    """Bend about an axis: lines along ``normal x axis`` become arcs between the bounds and stay straight beyond.

    With k = angle / (high - low), q = 1 - k z inside the bounds and 1 outside, z along the normal: det J = q. Where
    k z >= 1 the map folds; it still works, with a warning (Barr 1984, section 3.4).

    Parameters
    ----------
    axis
        About which is bent, right-handed.
    normal
        Towards which the ends rise for a positive angle; what it has along the axis is left out.
    origin
        (3,) its plane across the normal keeps its lengths.
    bounds
        The piece that is bent: positions along :attr:`along`, x . along, from the world's origin.
    angle
        Radians from the low bound to the high one. Its control.
    center
        The position along :attr:`along` that stays where it is; None = the middle between the bounds.

    Raises
    ------
    InvalidDeformer
        A normal along the axis, and what :class:`~pliant.space.axial.AxialDeformer` refuses.
    """

    axis: Axis = "x"
    normal: Axis = "z"
    angle: float = field(default=0.0, metadata={"unit": "radians"})
    center: float | None = None

    parameters: ClassVar[tuple[str, ...]] = ("angle",)
    neutral: ClassVar[Mapping[str, float]] = MappingProxyType({"angle": 0.0})

    def __post_init__(self) -> None:
        super().__post_init__()
        self._frame  # noqa: B018 -- a normal along the axis is refused now, not later
        if self.center is not None:
            object.__setattr__(self, "center", one_number("center", self.center))

    @property
    def along(self) -> Floats:
        """(3,) the direction that is bent: normal x axis."""
        return self._frame[2, :3]

    @cached_property
    def _frame(self) -> Floats:
        about = unit_axis(self.axis)
        normal = unit_axis(self.normal, "normal")
        return self._frame_across(normal, np.cross(normal - (normal @ about) * about, about))

    def _table(self, q: Floats, numbers: Numbers) -> Entries:
        bent, straight = self._split(q)
        theta = numbers[0] / self._width * bent
        sine, less = np.sin(theta), -2 * np.sin(theta / 2) ** 2  # cos(theta) - 1, zero exactly at rest
        return {
            (0, 0): bent * np.sin(theta / 2) * _sinc(theta / 2) + sine * straight,
            (0, 1): less,
            (2, 0): bent * (_sinc(theta) - 1) + less * straight,
            (2, 1): -sine,
        }

    def _slopes(self, q: Floats) -> Entries:
        curvature = self.angle / self._width
        theta = curvature * self._split(q)[0]
        sine, cosine, inside = np.sin(theta), np.cos(theta), self._between(q)
        turning = np.where(inside, curvature, 0.0)
        return {(0, 0): sine, (0, 1): -turning * sine, (2, 0): cosine - 1, (2, 1): -turning * cosine}

    def inverse(self, points: ArrayLike, *, tolerance: float = 1e-10, iterations: int = 50) -> Points:
        """Where (n, 3) points came from, in closed form.

        Raises
        ------
        NotConverged
            Points that no point of the fold-free side is mapped to.
        """
        images = as_points(points)
        frame, k, center = self._frame, self.angle / self._width, self._center
        local = images @ frame[:, :3].T + frame[:, 3]
        height, offset = local[:, 0], local[:, 2] - center
        ends = np.array(self.bounds) - center
        middle = k * ends.mean()
        turn = np.arctan2(k * offset, 1 - k * height) - middle
        theta = np.clip(middle + np.remainder(turn + np.pi, 2 * np.pi) - np.pi, *np.sort(k * ends))
        bent = theta / k if k else np.clip(offset, *ends)
        foot_z, foot_s = bent * np.sin(theta / 2) * _sinc(theta / 2), bent * _sinc(theta)
        z, s = height - foot_z, offset - foot_s  # seen from the foot on the arc, then turned back
        straight, normal = np.cos(theta) * s + np.sin(theta) * z, np.cos(theta) * z - np.sin(theta) * s
        result = images + np.outer(normal - height, frame[0, :3]) + np.outer(bent + straight - offset, frame[2, :3])
        missed = np.linalg.norm(self._quietly(result) - images, axis=1)
        scale = float(np.linalg.norm(np.ptp(np.vstack([images, result]), axis=0))) if len(images) else 1.0
        lost = np.flatnonzero(~(missed <= tolerance * (scale or 1.0)) | (self._folded(result)))
        if len(lost):
            raise NotConverged(
                f"{len(lost)} of {len(images):,} points are where the bend folds over itself: they have no unique "
                f"inverse; the first is point {lost[0]} at {images[lost[0]]}"
            )
        return result

    def _move(self, points: Points, out: Points) -> bool:
        finite = super()._move(points, out)
        count = int(self._folded(points).sum()) if self.angle else 0
        if count:
            warnings.warn(
                f"the bend folds at {count} of {len(points):,} points: they lie beyond its centre of curvature, "
                f"{abs(self._width / self.angle):.4g} from the origin's plane; bend less, or over a longer piece",
                PliantWarning,
                stacklevel=5,
            )
        return finite

    def _quietly(self, points: Points) -> Points:
        out = np.empty_like(points)
        super()._move(points, out)
        return out

    def _folded(self, points: Points) -> NDArray[np.bool_]:
        """Which points lie between the bounds and beyond the centre of curvature."""
        height = section_of(points, self._frame[[1, 2, 0]])
        folded = np.asarray(self.angle / self._width * height >= 1)
        if folded.any():
            folded &= self._between(self._sections(points))
        return folded

    @property
    def _center(self) -> float:
        return sum(self.bounds) / 2 if self.center is None else self.center

    def _split(self, q: Floats) -> tuple[Floats, Floats]:
        """Positions from the center: what of them is bent, and what goes on straight."""
        clamped = np.clip(q, *self.bounds)
        return clamped - self._center, q - clamped


def _sinc(x: Any) -> Any:
    """Sin(x) / x, for complex numbers too."""
    return np.divide(np.sin(x), x, out=np.ones_like(x), where=x != 0)
