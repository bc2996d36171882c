"""Tracks: keys of one value over time, and what lies between them."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidParameter
from pliant.numerics.ragged import frozen
from pliant.scene.easing import Easing, checked_easing, eased
from pliant.scene.motions import between

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Key:
    """A value at a time.

    Parameters
    ----------
    time
        In seconds, not negative.
    value
        A number, or an array.
    easing
        How it is reached from the key before.

    Raises
    ------
    InvalidParameter
        A time or a value that is not finite, an unknown easing.
    """

    time: float
    value: ArrayLike
    easing: Easing = "linear"

    def __post_init__(self) -> None:
        try:
            time, value = float(self.time), np.asarray(self.value, np.float64)
        except (TypeError, ValueError) as error:
            raise InvalidParameter(f"a key at {self.time!r} holds {self.value!r}: numbers are needed") from error
        if not 0 <= time < np.inf:
            raise InvalidParameter(f"a key is at {time} s; times are finite and not negative")
        if not np.isfinite(value).all():
            raise InvalidParameter(f"the key at {time:g} s holds values that are not finite")
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "value", frozen(value, np.float64))
        object.__setattr__(self, "easing", checked_easing(self.easing))


@dataclass(frozen=True, eq=False)
class Track:
    """The keys of one value of one layer, ascending in time.

    Parameters
    ----------
    layer
        The layer's name.
    field
        What changes: a field of its deformer, ``"controls"``, ``"envelope"``, ``"muted"``, or ``"frame"``, where the
        deformer is placed.
    keys
        At least one.

    Raises
    ------
    InvalidParameter
        No keys, keys out of order, or values of different shapes.
    """

    layer: str
    field: str
    keys: tuple[Key, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "keys", tuple(self.keys))
        name = f"{self.field!r} of layer {self.layer!r}"
        if not self.keys:
            raise InvalidParameter(f"{name} has no keys: set one, or remove the track")
        times = [key.time for key in self.keys]
        for earlier, later in pairwise(times):
            if earlier >= later:
                raise InvalidParameter(
                    f"the keys of {name} are out of order: one at {earlier:g} s comes before one at {later:g} s"
                )
        shapes = {np.shape(key.value) for key in self.keys}
        if len(shapes) > 1:
            raise InvalidParameter(f"the keys of {name} have values of different shapes: {sorted(shapes)}")

    def with_key(self, key: Key) -> Track:
        """The track with one more key; one at the same time is replaced."""
        kept = [each for each in self.keys if each.time != key.time]
        return replace(self, keys=tuple(sorted([*kept, key], key=lambda each: each.time)))

    def without(self, time: float) -> Track | None:
        """The track without the key at a time; None where that was the last.

        Raises
        ------
        InvalidParameter
            There is no key at that time.
        """
        kept = tuple(key for key in self.keys if key.time != time)
        if len(kept) == len(self.keys):
            raise InvalidParameter(f"{self.field!r} of layer {self.layer!r} has no key at {time:g} s")
        return replace(self, keys=kept) if kept else None

    def at(self, time: float) -> Any:
        """The value at a time: constant before the first key and after the last."""
        later = bisect_right([key.time for key in self.keys], time)
        if later == 0 or later == len(self.keys):
            return np.asarray(self.keys[max(later - 1, 0)].value)
        first, second = self.keys[later - 1], self.keys[later]
        part = (time - first.time) / (second.time - first.time)
        if second.easing == "cubic":
            return self._through(later, part)
        return self._mixed(np.asarray(first.value), np.asarray(second.value), eased(second.easing, part))

    def _mixed(self, first: Floats, second: Floats, part: float) -> Floats:
        if first.shape == (4, 4) and self.field in ("frame", "matrix"):
            return between(first, second, part)
        return np.asarray(first + part * (second - first))

    def _through(self, later: int, part: float) -> Floats:
        """Hermite's cubic with the slopes of the parabolas through neighbouring keys (Catmull-Rom in uneven time)."""
        first, second = self.keys[later - 1], self.keys[later]
        width = second.time - first.time
        start, end = np.asarray(first.value), np.asarray(second.value)
        one, two = width * self._slope(later - 1), width * self._slope(later)
        u = part
        return np.asarray(
            (2 * u**3 - 3 * u**2 + 1) * start + (u**3 - 2 * u**2 + u) * one
            + (3 * u**2 - 2 * u**3) * end + (u**3 - u**2) * two
        )  # fmt: skip

    def _slope(self, at: int) -> Floats:
        """Zero at the ends: a motion begins and ends at rest."""
        if at in (0, len(self.keys) - 1):
            return np.zeros(np.shape(self.keys[at].value))
        before, here, after = self.keys[at - 1 : at + 2]
        left, right = here.time - before.time, after.time - here.time
        first = (np.asarray(here.value) - np.asarray(before.value)) / left
        second = (np.asarray(after.value) - np.asarray(here.value)) / right
        return np.asarray((right * first + left * second) / (left + right))
