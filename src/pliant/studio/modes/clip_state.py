"""The clip as a page is told it: its times, its tracks with their keys, and the curves between these as drawn lines."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from pliant.errors import PliantError
from pliant.scene.keyed import tool_of
from pliant.scene.kinds import kind_of
from pliant.scene.track import Key, Track
from pliant.studio.modes.posing import clip_of, keyable

if TYPE_CHECKING:
    from pliant.scene.clip import Clip
    from pliant.scene.scene import Scene

Floats = NDArray[np.float64]

_DEGREE = 180 / np.pi
_STEPS = 24  # of a curve between two keys
_MOST_DRAWN = 4000  # points of a curve
_known: WeakKeyDictionary[Track, tuple[float, dict[str, Any]]] = WeakKeyDictionary()  # tracks never change


def clip_state(scene: Scene, time: float, recording: bool) -> dict[str, Any]:
    """What a page knows of the scene's motion."""
    clip = clip_of(scene)
    return {
        "exists": scene.clip is not None,
        "duration": clip.duration,
        "fps": clip.fps,
        "ending": clip.ending,
        "intensity": clip.intensity,
        "amplify": clip.amplify,
        "motion": clip.motion is not None,
        "period": clip.period,
        "time": time,
        "recording": recording,
        "tracks": [track_state(clip, track) for track in clip.tracks],
        "keyable": {layer.name: keyable(layer) for layer in scene.stack},
    }


def track_state(clip: Clip, track: Track) -> dict[str, Any]:
    """A track: its keys, and its curves as heights at common times.

    Values are as people see them: angles in degrees. Of one number there is one curve, of a vector one a component.
    What holds more numbers has one that tells how far it has come: the length of the way through the keys.
    """
    known = _known.get(track)
    if known is None or known[0] != clip.duration:
        known = _known[track] = clip.duration, _described(track, clip.duration, unit_of(clip, track))
    return known[1]


def unit_of(clip: Clip, track: Track) -> float:
    """By what a track's values are multiplied for people: they see angles in degrees."""
    try:
        fields = kind_of(tool_of(clip.stack[track.layer].deformer)).fields
    except PliantError:
        return 1.0
    return _DEGREE if any(field.name == track.field and field.type == "angle" for field in fields) else 1.0


def _described(track: Track, duration: float, unit: float) -> dict[str, Any]:
    values = np.stack([np.asarray(key.value, np.float64).reshape(-1) for key in track.keys])
    plain = values.shape[1] <= 3
    heights = values if plain else _ways(values)
    keys = [
        {"time": key.time, "value": height, "easing": key.easing}
        for key, height in zip(track.keys, (unit * heights).tolist(), strict=True)
    ]
    times = _times(track.keys, duration)
    drawn = track if plain else _way_track(track, heights)
    curve = np.stack([np.asarray(drawn.at(time)).reshape(-1) for time in times])
    return {
        "layer": track.layer,
        "field": track.field,
        "plain": plain,
        "unit": "°" if unit != 1.0 else "",
        "keys": keys,
        "times": np.round(times, 6).tolist(),
        "curves": np.round(unit * curve.T, 9).tolist(),
    }


def _ways(values: Floats) -> Floats:
    """(k, 1) how far it is from the first of some values to each, from one to the next."""
    steps = np.linalg.norm(np.diff(values, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])[:, None]


def _way_track(track: Track, heights: Floats) -> Track:
    """The same keys and easings, on the way between them."""
    keys = [Key(key.time, float(height[0]), key.easing) for key, height in zip(track.keys, heights, strict=True)]
    return Track(track.layer, track.field, tuple(keys))


def _times(keys: tuple[Key, ...], duration: float) -> Floats:
    """From the beginning to the end, with every key and so many moments between two."""
    steps = max(2, min(_STEPS, _MOST_DRAWN // max(len(keys), 1)))
    found = [np.array([0.0, duration])]
    for first, second in pairwise(keys):
        last = np.nextafter(second.time, first.time)  # just before a step
        found.append(np.append(np.linspace(first.time, second.time, steps + 1), last))
    found.append(np.array([key.time for key in keys]))
    return np.unique(np.concatenate(found))
