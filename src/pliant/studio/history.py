"""The history: a list of scenes. Scenes are frozen, so that undoing is going back in the list."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from pliant.scene.scene import Scene

MOST = 200  # entries; older ones are forgotten


@dataclass(frozen=True)
class Entry:
    """A scene, and what was done to arrive at it.

    Parameters
    ----------
    scene
        The scene.
    key
        What was done, as the page's table of strings calls it.
    subject
        To what: a name.
    """

    scene: Scene
    key: str
    subject: str = ""


class History:
    """Scenes one after another, and which of them is shown."""

    def __init__(self, first: Entry) -> None:
        self._entries, self._at = [first], 0

    @property
    def scene(self) -> Scene:
        """The scene that is shown."""
        return self._entries[self._at].scene

    @property
    def position(self) -> int:
        """Which entry is shown, counted from 0."""
        return self._at

    @property
    def entries(self) -> Iterable[Entry]:
        """All of them, the oldest first."""
        return tuple(self._entries)

    def push(self, entry: Entry) -> None:
        """Add a scene after the one shown; what had been undone is forgotten."""
        self._entries[self._at + 1 :] = [entry]
        del self._entries[: max(len(self._entries) - MOST, 0)]
        self._at = len(self._entries) - 1

    def go(self, position: int) -> bool:
        """Show another entry; False where there is none, or it is the one shown."""
        if not 0 <= position < len(self._entries) or position == self._at:
            return False
        self._at = position
        return True
