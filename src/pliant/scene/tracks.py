"""All tracks of a clip: keys are set, taken away, and checked against the stack that they move."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pliant.errors import InvalidParameter
from pliant.scene.easing import Easing, checked_easing
from pliant.scene.keyed import checked_value
from pliant.scene.stack import Stack
from pliant.scene.track import Key, Track

Tracks = tuple[Track, ...]


def require_tracks(tracks: Tracks, stack: Stack) -> None:
    """Make sure that tracks are of different values, and that their layers can have these.

    Raises
    ------
    InvalidParameter
        Two tracks of one value, no such layer or field, a value of another shape.
    """
    seen: set[tuple[str, str]] = set()
    for track in tracks:
        if (track.layer, track.field) in seen:
            raise InvalidParameter(f"{track.field!r} of layer {track.layer!r} has two tracks: join their keys")
        seen.add((track.layer, track.field))
        for key in track.keys:
            checked_value(stack[track.layer], track.field, key.value)


def with_keys(
    tracks: Tracks, stack: Stack, layer: str, time: float, values: Mapping[str, Any], easing: Easing | Sequence[float]
) -> Tracks:
    """The tracks with one more key for each of some values of a layer; parameters as for :meth:`Clip.key`.

    Raises
    ------
    InvalidParameter
        No such layer or field, a value of another shape, an unknown easing.
    """
    found = {(track.layer, track.field): track for track in tracks}
    given = checked_easing(easing)
    for field, value in values.items():
        key = Key(time, checked_value(stack[layer], field, value), given)
        track = found.get((layer, field))
        found[layer, field] = Track(layer, field, (key,)) if track is None else track.with_key(key)
    return tuple(found.values())


def without_key(tracks: Tracks, layer: str, field: str, time: float) -> Tracks:
    """The tracks without one key; a track without keys is gone.

    Raises
    ------
    InvalidParameter
        There is no such key.
    """
    found = [track for track in tracks if (track.layer, track.field) == (layer, field)]
    if not found:
        raise InvalidParameter(f"{field!r} of layer {layer!r} has no keys")
    changed = [track.without(time) if track is found[0] else track for track in tracks]
    return tuple(track for track in changed if track is not None)
