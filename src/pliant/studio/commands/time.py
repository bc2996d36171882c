"""Time: the playhead, single moments, the clip's own numbers, and its keys."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import Points
from pliant.scene.clip import Clip
from pliant.scene.easing import checked_easing
from pliant.scene.stack import Stack
from pliant.studio.dragging import Dragging, begin, cancel, commit, ongoing
from pliant.studio.modes.clip_state import track_state
from pliant.studio.modes.key_edits import doubled_keys, eased_keys, key_names, moved_keys, stretched, without_keys
from pliant.studio.modes.posing import clip_of, value_of, with_key
from pliant.studio.request import Client, Request, command
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session

MOST_FRAMES = 100_000


class KeyDrag(Dragging):
    """Keys, or the handles of an easing, follow the pointer; the shape at the playhead follows them."""

    def __init__(self, session: Session, client: Client, names: list[Any]) -> None:
        self._names = key_names(names)
        super().__init__(session, client, self._names[0][0], "keys")
        self._start = self._clip = clip_of(session.required)
        self._time = session.time

    def move(self, request: Request) -> tuple[NDArray[np.integer], Points, dict[str, NDArray[Any]]]:
        if "easing" in request.values:
            self._clip = eased_keys(self._start, self._names, checked_easing(request.several("easing", 4)))
        else:
            by, rise = request.number("by", 0.0), request.number("rise", 0.0)
            self._clip = moved_keys(self._start, self._names, by, rise, request.integer("component", 0))
        points = self._session.shown.binding.updated(self.stack, self._clip.base_at(self._time)).result
        return np.arange(len(points)), points, {}

    def preview(self, request: Request) -> Frame:
        """The answer to a move, with the tracks as they would be."""
        answer = super().preview(request)
        tracks = [track_state(self._clip, track) for track in self._clip.tracks]
        return Frame({**answer.head, "tracks": tracks}, answer.arrays)

    @property
    def stack(self) -> Stack:
        return self._clip.stack_at(self._time)

    @property
    def scene(self) -> Any:
        return self._session.required.replace(clip=self._clip)


@command("time.goto")
def goto(session: Session, request: Request) -> None:
    """The playhead to a time; ``anew`` where the page shows a moment that is only near."""
    if request.values.get("anew"):
        session.shown.told[:] = np.nan
    session.go_to(_time(session, request))


@command("time.frame", reads=True)
def frame(session: Session, request: Request) -> Frame:
    """The shape at a time, which is not kept: while somebody scrubs or plays."""
    stage, time = session.shown, _time(session, request)
    points = stage.at(time)
    moved = stage.drawn.moved(points, np.arange(len(points)))
    return Frame({"low": moved.low, "high": moved.high}, {"positions": moved.positions, "normals": moved.normals})


@command("time.record")
def record(session: Session, request: Request) -> None:
    """Whether edits set keys."""
    session.recording = request.truth("on")
    session.tell_scene()


@command("time.clip")
def numbers(session: Session, request: Request) -> None:
    """Duration, frames a second, ending and strength of the clip; keys are stretched with it where asked for."""
    clip = clip_of(session.required)
    values = request.values
    if "duration" in values:
        duration = request.number("duration")
        clip = stretched(clip, duration) if values.get("stretch") else replace(clip, duration=duration)
    numbers: dict[str, Any] = {name: request.number(name) for name in ("fps", "intensity", "amplify") if name in values}
    clip = replace(clip, **numbers)
    if "ending" in values:
        clip = replace(clip, ending=request.text("ending"))  # type: ignore[arg-type]
    if clip.period * clip.fps > MOST_FRAMES:
        raise InvalidParameter(f"that would be {clip.period * clip.fps:,.0f} frames; {MOST_FRAMES:,} are the most")
    _commit(session, clip, "clip")


@command("time.key")
def key(session: Session, request: Request) -> None:
    """Keys of some values of a layer as they are at the playhead."""
    scene, name = session.required, request.text("layer")
    clip, layer = clip_of(scene), scene.stack[name]
    for field in request.several("fields"):
        own = field == "controls" and not layer.in_space
        value = session.shown.controls(name) if own else value_of(layer, str(field))
        if value is None:
            raise InvalidParameter(f"layer {name!r} has no {field!r} that could have keys")
        clip = with_key(clip, name, str(field), _time(session, request), value)
    _commit(session, clip, "keys", name)


@command("time.remove")
def remove(session: Session, request: Request) -> None:
    """Without some keys."""
    names = key_names(request.several("keys"))
    _commit(session, without_keys(clip_of(session.required), names), "keysRemoved", names[0][0])


@command("time.ease")
def ease(session: Session, request: Request) -> None:
    """Another way to reach some keys: a name, or the handles of a curve."""
    names, easing = key_names(request.several("keys")), request.values.get("easing")
    if not isinstance(easing, str | list):
        raise InvalidParameter(f"{easing!r} is no easing: a name, or the four numbers of a curve's handles")
    _commit(session, eased_keys(clip_of(session.required), names, checked_easing(easing)), "easing", names[0][0])


@command("time.double")
def double(session: Session, request: Request) -> None:
    """Copies of some keys, the first of them at the playhead."""
    names = key_names(request.several("keys"))
    _commit(session, doubled_keys(clip_of(session.required), names, _time(session, request)), "keys", names[0][0])


@command("keys.begin")
def take_keys(session: Session, request: Request) -> None:
    """Take hold of keys."""
    begin(KeyDrag(session, request.client, request.several("keys")), session)


@command("keys.move")
def move_keys(session: Session, request: Request) -> Frame:
    """Move them."""
    return ongoing(session, request).preview(request)


command("keys.commit")(commit)
command("keys.cancel")(cancel)


def _time(session: Session, request: Request) -> float:
    """A time within the clip; the playhead's where none is given."""
    time = request.number("time", session.time)
    return min(max(time, 0.0), clip_of(session.required).period)


def _commit(session: Session, clip: Clip, key: str, subject: str = "") -> None:
    session.drop_drag()
    session.commit(session.required.replace(clip=clip), key, subject)
