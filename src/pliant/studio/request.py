"""What a page asks for, and what it is answered; the registry of commands."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.studio.serving.frames import Arrays, Frame

if TYPE_CHECKING:
    from pliant.studio.session import Session

_MOST = 1 << 63


class Client(Protocol):
    """A page: somewhere to send frames to."""

    def send(self, data: bytes) -> None: ...


@dataclass(frozen=True)
class Request:
    """A command's values and arrays, checked as they are asked for.

    Parameters
    ----------
    client
        Who asks.
    values
        What JSON holds.
    arrays
        Numbers beside it.
    """

    client: Client
    values: Mapping[str, Any]
    arrays: Arrays

    def text(self, name: str, default: str | None = None) -> str:
        """A string."""
        return str(self._value(name, str, default))

    def number(self, name: str, default: float | None = None) -> float:
        """A finite number."""
        value = float(self._value(name, (int, float), default))
        if not math.isfinite(value):
            raise InvalidParameter(f"{name} is {value}; it must be finite")
        return value

    def integer(self, name: str, default: int | None = None) -> int:
        """A whole number of 64 bits."""
        value = int(self._value(name, int, default))
        if not -_MOST <= value < _MOST:
            raise InvalidParameter(f"{name} is {value}; that is more than 64 bits hold")
        return value

    def truth(self, name: str) -> bool:
        """True or false."""
        return bool(self._value(name, bool, None))

    def names(self, name: str) -> dict[str, Any]:
        """Values by name."""
        return dict(self._value(name, dict, None))

    def several(self, name: str, count: int | None = None) -> list[Any]:
        """A list."""
        found = list(self._value(name, list, None))
        if count is not None and len(found) != count:
            raise InvalidParameter(f"{name} has {len(found)} entries; {count} are needed")
        return found

    def numbers(self, name: str, count: int) -> NDArray[np.float64]:
        """(count,) finite numbers."""
        found = self.several(name, count)
        plain = all(isinstance(each, (int, float)) and not isinstance(each, bool) for each in found)
        if not plain or not all(math.isfinite(each) for each in found):
            raise InvalidParameter(f"{name} is {found!r}; {count} finite numbers are needed")
        return np.array(found, np.float64)

    def points(self, name: str) -> NDArray[np.float64]:
        """(k, 3) positions."""
        array = self.array(name)
        if len(array) % 3:
            raise InvalidParameter(f"{name} has {len(array)} numbers; three a position are needed")
        return np.asarray(array, np.float64).reshape(-1, 3)

    def indices(self, name: str, count: int) -> NDArray[np.int64]:
        """(k,) indices below a count."""
        array = np.asarray(self.array(name), np.int64)
        if len(array) and not 0 <= array.min() <= array.max() < count:
            raise InvalidParameter(f"{name} holds {array.max()}; there are {count:,}, counted from 0")
        return array

    def array(self, name: str) -> NDArray[Any]:
        """An array as it came."""
        if name not in self.arrays:
            raise InvalidParameter(f"the array {name!r} is missing")
        return self.arrays[name]

    def _value(self, name: str, kind: type | tuple[type, ...], default: Any) -> Any:
        value = self.values.get(name, default)
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
            raise InvalidParameter(f"{name} is {value!r}, which this command does not take")
        return value


@dataclass(frozen=True)
class Later:
    """An edit that takes long to compute.

    Parameters
    ----------
    work
        What is computed beside the session, of what cannot change, while others go on.
    done
        Gets its result on the session's thread, and gives the answer.
    """

    work: Callable[[], Any]
    done: Callable[[Any], Frame | None]


Command = Callable[["Session", Request], Frame | Later | None]

COMMANDS: dict[str, Command] = {}
READING: set[str] = set()  # commands that change nothing: they are given the session as it stands, and wait for none


def command(name: str, reads: bool = False) -> Callable[[Command], Command]:
    """Register a function as a command of this name."""

    def register(function: Command) -> Command:
        COMMANDS[name] = function
        if reads:
            READING.add(name)
        return function

    return register
