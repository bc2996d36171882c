"""Barr's local deformation: tangents are turned and stretched along the axis, and integrated to positions.

The axis is cut into segments. In each of them the frame turns at a constant rate and the axis is stretched by a
constant factor, so that the integral X(s) = integral of (1 + stretch) R(s) t ds (Barr 1984, eq. 5.1) is an arc of a
screw, in closed form: no step size, no drift.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Controls, checked_controls
from pliant.errors import InvalidDeformer
from pliant.numerics.maps.sections import Entries
from pliant.numerics.ragged import frozen
from pliant.space.axial import AxialDeformer, Numbers

Floats = NDArray[np.float64]

_ALONG = np.array([0.0, 0.0, 1.0])  # the axis in its own frame


@dataclass(frozen=True, eq=False, kw_only=True)
class TangentFrames(AxialDeformer):
    """Bend, twist and stretch the axis segment by segment; sections follow it rigidly (Barr 1984, eq. 5.1).

    Beyond the low bound nothing moves, beyond the high one space goes on straight. det J is the stretch times one
    minus the curvature times the distance from the axis.

    Parameters
    ----------
    axis, origin, bounds
        See :class:`~pliant.space.axial.AxialDeformer`.
    rates
        (k, 4) for each of k segments of equal length how much it turns, in radians, about the two directions across
        the axis and about the axis itself, all carried along, and by what part of its length it grows; above -1. Its
        controls, one after another.

    Raises
    ------
    InvalidDeformer
        Another shape, numbers that are not finite, a segment that shrinks to nothing.
    """

    rates: ArrayLike = field(default_factory=lambda: np.zeros((8, 4)))

    parameters: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        rates = np.asarray(self.rates, np.float64)
        if rates.ndim != 2 or rates.shape[1] != 4 or not len(rates) or not np.isfinite(rates).all():
            raise InvalidDeformer(f"rates of shape {rates.shape}: (k, 4) finite numbers are needed, k segments")
        if (rates[:, 3] <= -1).any():
            first = int(np.argmax(rates[:, 3] <= -1))
            raise InvalidDeformer(f"segment {first} grows by {rates[first, 3]:g} of its length; it must be above -1")
        object.__setattr__(self, "rates", frozen(rates, np.float64))

    @property
    def rest(self) -> Controls:
        """(4 k,) zeros."""
        return np.zeros(np.size(self.rates))

    @property
    def controls(self) -> Controls:
        """(4 k,) the rates, segment by segment."""
        return np.asarray(self.rates).reshape(-1)

    def moved(self, controls: ArrayLike) -> Self:
        """The deformer with (4 k,) other rates."""
        return replace(self, rates=checked_controls(controls, self.rest.shape).reshape(-1, 4))

    def _table(self, q: Floats, numbers: Numbers) -> Entries:
        return _entries(self._swept(q, numbers.reshape(-1, 4))[0])

    def _slopes(self, q: Floats) -> Entries:
        return _entries(self._swept(q, np.asarray(self.rates))[1])

    def _swept(self, q: Floats, rates: Numbers) -> tuple[Numbers, Numbers]:
        """(n, 3, 3) for the sections q: the axis's displacement, and what is added to the two directions; slopes."""
        count, length = len(rates), self._width / len(rates)
        starts, frames = [np.zeros(3, rates.dtype)], [np.eye(3, dtype=rates.dtype)]
        for rate in rates:
            turn, shift = _screw(rate[None], np.ones(1), length)
            starts.append(starts[-1] + frames[-1] @ shift[0] + length * (frames[-1] - np.eye(3)) @ _ALONG)
            frames.append(frames[-1] @ turn[0])
        place = (q - self.bounds[0]) / length
        piece = np.clip(np.floor(place), -1, count).astype(np.int64)  # -1 before the first segment, k after the last
        inside = (piece >= 0) & (piece < count)
        at = np.clip(piece, 0, count - 1)
        turn, shift = _screw(rates[at], np.where(inside, place - at, 0.0), length)
        frame, start = np.array(frames)[np.maximum(piece, 0)], np.array(starts)[np.maximum(piece, 0)]
        frame[piece < 0] = np.eye(3)
        straight = (place - np.clip(piece, 0, count)) * length
        leaning = (frame - np.eye(3)) @ _ALONG
        turned = frame @ turn
        center = start + np.einsum("nij,nj->ni", frame, shift) + straight[:, None] * leaning
        values = np.stack([center, turned[:, :, 0] - [1, 0, 0], turned[:, :, 1] - [0, 1, 0]], axis=2)
        spin = np.where(inside[:, None], rates[at, :3], 0.0) / length
        grown = np.where(inside, rates[at, 3], 0.0)
        tangent = (1 + grown)[:, None] * turned[:, :, 2] - _ALONG
        sideways = [np.einsum("nij,nj->ni", turned, np.cross(spin, np.eye(3)[i])) for i in range(2)]
        return values, np.stack([tangent, *sideways], axis=2)


def _screw(rates: Numbers, part: Floats, length: float) -> tuple[Numbers, Numbers]:
    """(n, 3, 3) the turn over a part of a segment, and (n, 3) how far the axis has left its straight course."""
    turn = rates[:, :3] * part[:, None]
    angle = np.sqrt((turn * turn).sum(axis=1))
    axis = np.divide(turn, angle[:, None], out=np.zeros_like(turn), where=angle[:, None] != 0)
    cross = np.zeros((len(turn), 3, 3), turn.dtype)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        cross[:, i, j], cross[:, j, i] = -axis[:, k], axis[:, k]
    square = cross @ cross
    half = angle / 2
    sine = np.sin(angle)[:, None, None]
    less = 2 * np.sin(half)[:, None, None] ** 2  # 1 - cos(angle)
    sinc = np.divide(np.sin(angle), angle, out=np.ones_like(angle), where=angle != 0)
    mean = np.divide(less[:, 0, 0], angle, out=np.zeros_like(angle), where=angle != 0)
    turned = np.eye(3) + sine * cross + less * square
    drift = mean[:, None] * cross[:, :, 2] + (1 - sinc)[:, None] * square[:, :, 2]  # of the mean tangent
    growth = rates[:, 3][:, None]
    shift = (part * length)[:, None] * ((1 + growth) * drift + growth * _ALONG)
    return turned, shift


def _entries(values: Numbers) -> dict[tuple[int, int], Any]:
    return {(i, j): values[:, i, j] for i in range(3) for j in range(3)}
