"""Clips as plain data and back. Mesh and stack are the scene's, and not part of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.scene.clip import Clip
from pliant.scene.sequence import MeshSequence
from pliant.scene.stack import Stack
from pliant.scene.track import Key, Track
from pliant.scene.values import Arrays, decode, encode

NUMBERS = ("duration", "fps", "ending", "intensity", "amplify")


def clip_data(clip: Clip, arrays: Arrays) -> dict[str, Any]:
    """A clip as plain data; arrays are put aside."""
    data: dict[str, Any] = {name: getattr(clip, name) for name in NUMBERS}
    data["tracks"] = [_track_data(track, arrays, f"clip/{i}") for i, track in enumerate(clip.tracks)]
    if clip.motion is not None:
        points, times = np.asarray(clip.motion.points), np.asarray(clip.motion.times)
        data["motion"] = {
            "points": encode(points, arrays, "clip/motion/points"),
            "times": encode(times, arrays, "clip/motion/times"),
        }
    return data


def clip_of(data: Any, arrays: Mapping[str, NDArray[Any]], mesh: PolygonMesh, stack: Stack) -> Clip:
    """The clip that plain data describes.

    Raises
    ------
    InvalidParameter
        Entries that are missing or not understood, keys out of order, layers that are not there.
    """
    if not isinstance(data, dict):
        raise InvalidParameter("the clip is no names and values")
    motion = data.get("motion")
    try:
        tracks = tuple(_track_of(each, arrays) for each in data.get("tracks", []))
        found = (
            None if motion is None else MeshSequence(*(_array(motion[name], arrays) for name in ("points", "times")))
        )
        values = {name: data[name] for name in NUMBERS if name in data}
        return Clip(mesh, stack, tracks=tracks, motion=found, **values)
    except (KeyError, TypeError, ValueError) as error:
        raise InvalidParameter(f"the clip is not understood: {type(error).__name__} {error}") from error


def _track_data(track: Track, arrays: Arrays, name: str) -> dict[str, Any]:
    keys = []
    for i, key in enumerate(track.keys):
        value = np.asarray(key.value)
        plain = float(value) if value.ndim == 0 else encode(value, arrays, f"{name}/{i}")
        easing = key.easing if isinstance(key.easing, str) else list(key.easing)
        keys.append({"time": key.time, "value": plain, "easing": easing})
    return {"layer": track.layer, "field": track.field, "keys": keys}


def _track_of(data: Any, arrays: Mapping[str, NDArray[Any]]) -> Track:
    keys = tuple(Key(key["time"], _array(key["value"], arrays), key.get("easing", "linear")) for key in data["keys"])
    return Track(str(data["layer"]), str(data["field"]), keys)


def _array(data: Any, arrays: Mapping[str, NDArray[Any]]) -> NDArray[Any]:
    return np.asarray(decode(data, arrays))
