"""A drag: begun, previewed as often as the page likes, committed as one entry of the history.

While it lasts the scene stays as it was. What has been told to the pages is forgotten for the points that previews
touch, so that committing or giving up sends these again, exactly.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import Points
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.studio.request import Client, Request
from pliant.studio.serving.frames import Frame

if TYPE_CHECKING:
    from pliant.studio.session import Session


class DragOver(InvalidParameter):
    """There is no drag any more: something else has changed the scene meanwhile."""


class Dragging(ABC):
    """An interaction under way.

    Parameters
    ----------
    session
        Where it happens.
    client
        The page that drags.
    layer
        The layer that is changed.
    key
        What the history will call it.
    stack
        Where the layer is, while it is none of the scene's; None = the scene's.
    """

    def __init__(self, session: Session, client: Client, layer: str, key: str, stack: Stack | None = None) -> None:
        if session.dragging is not None and session.dragging.client is not client:
            raise InvalidParameter("another page is dragging just now: let it finish first")
        session.drop_drag()
        self.client: Client = client
        self.layer, self.key, self._session = layer, key, session
        self._index: NDArray[np.integer] | None = None
        (session.shown.scene.stack if stack is None else stack).index(layer)  # there is such a layer

    @abstractmethod
    def move(self, request: Request) -> tuple[NDArray[np.integer], Points, dict[str, NDArray[Any]]]:
        """Preview: the points that changed, all positions, and further arrays for the page."""

    @property
    @abstractmethod
    def stack(self) -> Stack:
        """The stack as it would be committed."""

    @property
    def scene(self) -> Scene:
        """The scene as it would be committed."""
        return self._session.required.replace(stack=self.stack)

    def preview(self, request: Request) -> Frame:
        """The answer to a move: the indices travel only when they are others than before."""
        touched, points, arrays = self.move(request)
        if not len(touched):
            return Frame({}, arrays)
        stage = self._session.shown
        everything = len(touched) == len(points)
        head: dict[str, Any] = {"all": everything}
        moved = stage.drawn.moved(points, touched)
        head |= {"low": moved.low, "high": moved.high}
        arrays |= {"positions": moved.positions, "normals": moved.normals}
        known = self._index is not None and (
            touched is self._index or (len(touched) == len(self._index) and np.array_equal(touched, self._index))
        )
        if not known:
            stage.told[touched] = np.nan  # only near: to be told again, exactly
            if not everything:
                arrays["index"] = touched.astype(np.uint32)
        self._index = touched
        self._tell_others(touched, points, everything)
        return Frame(head, arrays)

    def _tell_others(self, touched: NDArray[np.integer], points: Points, everything: bool) -> None:
        session = self._session
        if len(session.clients) < 2:
            return
        arrays: dict[str, NDArray[Any]] = {
            "positions": points[touched].astype(np.float32),
            "normals": session.shown.drawn.normals(points, touched),
        }
        if not everything:
            arrays["index"] = touched.astype(np.uint32)
        session.broadcast(Frame({"event": "points", "all": everything}, arrays), leave_out=self.client)


def begin(dragging: Dragging, session: Session) -> None:
    """Let a drag begin."""
    session.dragging = dragging


def ongoing(session: Session, request: Request) -> Dragging:
    """The drag of the page that asks.

    Raises
    ------
    DragOver
        It has none: it was given up, or never begun.
    """
    if session.dragging is None or session.dragging.client is not request.client:
        raise DragOver("there is no drag under way on this page: something else has changed the scene; drag again")
    return session.dragging


def commit(session: Session, request: Request) -> None:
    """End a drag, keeping what it did."""
    found = ongoing(session, request)
    scene = found.scene
    session.dragging = None
    session.commit(scene, found.key, found.layer)


def cancel(session: Session, request: Request) -> None:
    """End a drag, undoing what it did."""
    ongoing(session, request)
    session.drop_drag()
