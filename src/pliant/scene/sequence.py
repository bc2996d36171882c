"""MeshSequence: one mesh whose points move over time, as point caches and animated files hold it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import Points
from pliant.numerics.given import as_numbers
from pliant.numerics.ragged import frozen


@dataclass(frozen=True, eq=False)
class MeshSequence:
    """Positions over time; in between they change in proportion, before the first and after the last they stay.

    Parameters
    ----------
    points
        (k, n, 3) finite positions of n points at k times.
    times
        (k,) in seconds, ascending.

    Raises
    ------
    InvalidParameter
        No frames, another shape, values that are not finite, times that do not ascend.
    """

    points: ArrayLike
    times: ArrayLike

    def __post_init__(self) -> None:
        points, times = np.asarray(self.points), as_numbers("times", self.times, InvalidParameter)
        if points.ndim != 3 or points.shape[2] != 3 or not len(points):
            raise InvalidParameter(f"a sequence of shape {points.shape}: (k, n, 3) is needed, one frame or more")
        if times.shape != points.shape[:1] or not np.isfinite(times).all() or (np.diff(times) <= 0).any():
            raise InvalidParameter(
                f"{len(points)} frames need as many finite times that ascend; given: {times.tolist()[:8]}"
            )
        kind = np.float32 if points.dtype == np.float32 else np.float64
        points = frozen(points, kind)
        if not np.isfinite(points).all():
            raise InvalidParameter(
                f"frame {np.argmax(~np.isfinite(points).all(axis=(1, 2)))} holds positions that are not finite"
            )
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "times", frozen(times, np.float64))

    def __len__(self) -> int:
        return len(np.asarray(self.points))

    @property
    def count(self) -> int:
        """n, how many points there are."""
        return int(np.asarray(self.points).shape[1])

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        times = np.asarray(self.times)
        return float(times[-1] - times[0])

    def at(self, time: float) -> Points:
        """(n, 3) the positions at a time, counted from the first frame.

        Parameters
        ----------
        time
            In seconds; between frames they are mixed, beyond the ends they stay.
        """
        points, times = np.asarray(self.points), np.asarray(self.times)
        place = np.interp(time + times[0], times, np.arange(len(times)))
        first = min(int(place), len(times) - 1)
        part = place - first
        here: Points = points[first].astype(np.float64)
        return here if part == 0 else np.asarray(here + part * (points[first + 1] - here))

    def amplified(self, rest: Points, factor: float) -> MeshSequence:
        """The motion exaggerated: rest + factor (frame - rest).

        Parameters
        ----------
        rest
            (n, 3) where the points rest.
        factor
            1 = as it is, 0 = at rest.
        """
        points: NDArray[np.float64] = rest + factor * (np.asarray(self.points, np.float64) - rest)
        return MeshSequence(points, self.times)
