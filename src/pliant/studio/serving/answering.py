"""From a frame to its answer, in steps, so that nobody waits for what somebody else has asked.

Commands that edit run on the session's thread, one after another. Beside it, as scenes are frozen, frames are decoded,
commands that only read are answered, and what an edit takes long for is computed before it comes to the session.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock
from typing import TYPE_CHECKING

from pliant.errors import InvalidParameter, PliantError, PliantWarning
from pliant.studio.request import COMMANDS, READING, Client, Later, Request
from pliant.studio.serving.frames import Frame, MalformedFrame

if TYPE_CHECKING:
    from pliant.studio.session import Session

SMALL = 1 << 16  # bytes of a frame that is decoded at once wherever it comes in


class Answer:
    """A command on its way to its answer.

    Parameters
    ----------
    session
        Of whom it asks.
    client
        Who asks.
    data
        The frame.

    Attributes
    ----------
    step
        What is to be done next; None = it has been answered. The first may raise MalformedFrame, the others nothing.
    beside
        Whether that may run on any thread; else it must run on the session's.
    """

    def __init__(self, session: Session, client: Client, data: bytes) -> None:
        self._session, self._client = session, client
        self.step: Callable[[], None] | None = lambda: self._decode(data)
        self.beside = True

    def _decode(self, data: bytes) -> None:
        frame = Frame.decode(data)
        known, name, values = frame.head.get("id"), frame.head.get("do"), frame.head.get("with", {})
        if not isinstance(known, int) or not isinstance(name, str) or not isinstance(values, dict):
            raise MalformedFrame("a frame is no command: it needs an id, a name and values")
        self._number, self._name = known, name
        self._request = Request(self._client, values, frame.arrays)
        self.beside, self.step = name in READING, self._run

    def _run(self) -> None:
        session = self._session.as_it_stands() if self.beside else self._session
        found = self._tried(lambda: _command(self._name)(session, self._request))
        if isinstance(found, Later):
            self.beside, self.step = True, lambda: self._compute(found)
        else:
            self._send(found)

    def _compute(self, later: Later) -> None:
        results = []
        found = self._tried(lambda: results.append(later.work()))
        if results:
            self.beside, self.step = False, lambda: self._send(self._tried(lambda: later.done(results[0])))
        else:
            self._send(found)

    def _tried(self, work: Callable[[], Frame | Later | None]) -> Frame | Later | None:
        try:
            with _quiet():
                return work()
        except PliantError as error:
            return _refusal(type(error).__name__, str(error))
        except OSError as error:
            return _refusal("OSError", f"{error.filename or 'file'}: {error.strerror}")
        except Exception as error:  # a bug must not end the session: the work in it would be lost
            return _refusal("Bug", f"this is a bug in pliant: {type(error).__name__}: {error}")

    def _send(self, found: Frame | Later | None) -> None:
        answer = found if isinstance(found, Frame) else Frame()
        self._client.send(Frame({**answer.head, "answer": self._number}, answer.arrays).encode())
        self.step = None


def _command(name: str) -> Callable[[Session, Request], Frame | Later | None]:
    if name not in COMMANDS:
        raise InvalidParameter(f"the studio knows no command {name!r}")
    return COMMANDS[name]


def _refusal(kind: str, message: str) -> Frame:
    return Frame({"error": {"kind": kind, "message": message}})


@contextmanager
def _quiet() -> Iterator[None]:
    """Pliant's warnings are for scripts. Filters are the process's: the first thread sets them, the last lifts them."""
    with _silence.lock:
        if not _silence.count:
            _silence.filters = warnings.catch_warnings()
            _silence.filters.__enter__()
            warnings.simplefilter("ignore", PliantWarning)
        _silence.count += 1
    try:
        yield
    finally:
        with _silence.lock:
            _silence.count -= 1
            if not _silence.count:
                _silence.filters.__exit__(None, None, None)


class _Silence:
    """How many threads have asked for silence."""

    def __init__(self) -> None:
        self.lock, self.count = Lock(), 0
        self.filters: warnings.catch_warnings[None] = warnings.catch_warnings()


_silence = _Silence()
