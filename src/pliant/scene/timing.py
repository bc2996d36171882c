"""When a clip is where: how long it lasts, how it goes on, and at which times its frames are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from pliant.errors import InvalidParameter
from pliant.numerics.given import as_number

Ending = Literal["once", "loop", "ping-pong"]


@dataclass(frozen=True)
class Timing:
    """The times of a clip.

    Parameters
    ----------
    duration, fps
        Seconds, and frames a second; positive.
    ending
        As :class:`~pliant.scene.clip.Clip` says.

    Raises
    ------
    InvalidParameter
        A duration or a rate that is not positive, an unknown ending.
    """

    duration: float
    fps: float
    ending: Ending

    def __post_init__(self) -> None:
        for name in ("duration", "fps"):
            if not as_number(f"the clip's {name}", getattr(self, name), InvalidParameter) > 0:
                raise InvalidParameter(f"the clip is empty: its {name} is {getattr(self, name)}; it must be positive")
        if self.ending not in ("once", "loop", "ping-pong"):
            raise InvalidParameter(f"a clip ends by 'once', 'loop' or 'ping-pong', not {self.ending!r}")

    @property
    def period(self) -> float:
        """Seconds after which it has been all through."""
        return 2 * self.duration if self.ending == "ping-pong" else self.duration

    @property
    def times(self) -> tuple[float, ...]:
        """The times of its frames: of a clip that returns to its beginning, each moment once."""
        count = max(1, round(self.period * self.fps))
        last = count + 1 if self.ending == "once" else count
        return tuple(min(i / self.fps, self.period) for i in range(last))

    def moment(self, time: float) -> float:
        """Any time, in the keys' own count: between zero and the duration.

        Raises
        ------
        InvalidParameter
            It is no finite number.
        """
        given = as_number("the time", time, InvalidParameter)
        if self.ending == "once":
            return min(max(given, 0.0), self.duration)
        moment = given % self.period
        return self.period - moment if moment > self.duration else moment
