"""Whether anybody opens a file of a folder: Linux tells."""

from __future__ import annotations

import ctypes
import os
from pathlib import Path

_OPEN, _ACCESS = 0x20, 0x01
_EVENT = 16  # bytes of an event without its name


class Canary:
    """Counts openings and readings of files that nobody should touch.

    Parameters
    ----------
    folders
        Whose files they are.
    """

    def __init__(self, *folders: Path) -> None:
        library = ctypes.CDLL(None, use_errno=True)
        self._handle = library.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC)
        for folder in folders:
            if library.inotify_add_watch(self._handle, os.fsencode(folder), _OPEN | _ACCESS) < 0:
                raise OSError(ctypes.get_errno(), "no watch can be kept", str(folder))

    def touched(self) -> list[str]:
        """The names of files that were opened or read since the last call; the folder itself is an empty name."""
        found: list[str] = []
        while True:
            try:
                data = os.read(self._handle, 1 << 16)
            except BlockingIOError:
                return found
            at = 0
            while at < len(data):
                length = int.from_bytes(data[at + 12 : at + 16], "little")
                found.append(data[at + _EVENT : at + _EVENT + length].rstrip(b"\0").decode())
                at += _EVENT + length

    def close(self) -> None:
        """Stop counting."""
        os.close(self._handle)
