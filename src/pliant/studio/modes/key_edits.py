"""Keys of a clip, edited by the handful: moved in time and in value, given other easings, doubled, removed.

A key is named by its layer, its field and its time, as a page knows them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from pliant.errors import InvalidParameter
from pliant.scene.clip import Clip
from pliant.scene.easing import Easing
from pliant.scene.track import Key, Track
from pliant.studio.modes.clip_state import unit_of

Name = tuple[str, str, float]


def key_names(listed: Iterable[Any]) -> list[Name]:
    """The names of keys, as a page lists them.

    Raises
    ------
    InvalidParameter
        Something else.
    """
    found = []
    for each in listed:
        match each:
            case [str(layer), str(field), int() | float() as time]:
                found.append((layer, field, float(time)))
            case _:
                raise InvalidParameter(f"{each!r} names no key: a layer, a field and a time do")
    if not found:
        raise InvalidParameter("no key is selected: click one first")
    return found


def key_at(clip: Clip, name: Name) -> Key:
    """A key by its name.

    Raises
    ------
    InvalidParameter
        There is none.
    """
    layer, field, time = name
    for track in clip.tracks:
        if (track.layer, track.field) == (layer, field):
            for key in track.keys:
                if key.time == time:
                    return key
    raise InvalidParameter(f"{field!r} of layer {layer!r} has no key at {time:g} s")


def moved_keys(clip: Clip, names: list[Name], by: float, rise: float = 0.0, component: int = 0) -> Clip:
    """The clip with keys at other times, and with other values in one component, as people see them.

    They keep their distances: none comes before the beginning. One that arrives where another stands takes its place.
    """
    by = max(by, -min(time for _, _, time in names))
    keys = {}
    for name in names:
        key = key_at(clip, name)
        unit = next(unit_of(clip, track) for track in clip.tracks if (track.layer, track.field) == name[:2])
        keys[name] = _risen(key, rise / unit, component)
    rest = without_keys(clip, names)
    return _with_keys(clip, rest, [(name, replace(key, time=name[2] + by)) for name, key in keys.items()])


def doubled_keys(clip: Clip, names: list[Name], to: float) -> Clip:
    """The clip with copies of keys, the first of them at a time."""
    by = to - min(time for _, _, time in names)
    return _with_keys(clip, clip, [(name, replace(key_at(clip, name), time=name[2] + by)) for name in names])


def eased_keys(clip: Clip, names: list[Name], easing: Easing) -> Clip:
    """The clip with keys that are reached in another way."""
    return _with_keys(clip, clip, [(name, replace(key_at(clip, name), easing=easing)) for name in names])


def without_keys(clip: Clip, names: list[Name]) -> Clip:
    """The clip without some keys."""
    for layer, field, time in names:
        clip = clip.without_key(layer, field, time)
    return clip


def stretched(clip: Clip, duration: float) -> Clip:
    """The clip with another duration, its keys in proportion."""
    factor = duration / clip.duration
    tracks = [
        replace(track, keys=tuple(replace(key, time=key.time * factor) for key in track.keys)) for track in clip.tracks
    ]
    return replace(clip, duration=duration, tracks=tuple(tracks))


def _with_keys(clip: Clip, base: Clip, keys: list[tuple[Name, Key]]) -> Clip:
    """A clip with keys in the tracks of another, in its order: what was the last key of a track does not end it."""
    tracks = {(track.layer, track.field): track for track in base.tracks}
    for (layer, field, _), key in keys:
        track = tracks.get((layer, field))
        tracks[layer, field] = Track(layer, field, (key,)) if track is None else track.with_key(key)
    order = [(track.layer, track.field) for track in clip.tracks]
    return replace(clip, tracks=tuple(tracks[place] for place in order if place in tracks))


def _risen(key: Key, rise: float, component: int) -> Key:
    if rise == 0.0:
        return key
    value = np.array(key.value, np.float64)
    flat = value.reshape(-1)
    if not 0 <= component < min(flat.size, 3):
        raise InvalidParameter(f"the key at {key.time:g} s has no component {component}")
    flat[component] += rise
    return replace(key, value=value)
