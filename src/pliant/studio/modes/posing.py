"""The scene at a moment: what the keys say then is shown, and what people change there becomes keys.

A page always works on the posed scene: its stack holds the keyed values of the playhead's time. An edit of a value that
has keys sets one at that time; while recording, so does an edit of any value that can have keys.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import PliantError
from pliant.scene.clip import Clip
from pliant.scene.easing import Easing
from pliant.scene.keyed import tool_of
from pliant.scene.kinds import kind_of
from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.space.affine import Affine
from pliant.space.placed import Placed

USUAL: Easing = "ease_in_out"
FRESH = {"duration": 2.0, "fps": 24.0}  # of a clip that somebody begins
_MOST_NUMBERS = 16  # in a field that has keys of its own: a matrix


def posed(scene: Scene, time: float) -> Scene:
    """The scene as it stands at a time, in seconds."""
    clip = scene.clip
    return scene if clip is None or not clip.tracks else scene.replace(stack=clip.stack_at(time))


def within(scene: Scene, time: float) -> float:
    """A time, or the end of the scene's clip where that comes before."""
    return min(time, clip_of(scene).duration)


def clip_of(scene: Scene) -> Clip:
    """The scene's clip, or a fresh one without keys."""
    return Clip(scene.mesh, scene.stack, **FRESH) if scene.clip is None else scene.clip  # type: ignore[arg-type]


def keyed(before: Scene, after: Scene, time: float, recording: bool) -> Scene:
    """An edited scene whose changed values have keys.

    Parameters
    ----------
    before
        As it stood, posed at the time.
    after
        As it was edited.
    time
        Where keys are set, in seconds.
    recording
        Whether values without keys get some too.
    """
    known = set() if before.clip is None else set(before.clip.tracks)
    if (after.clip is None and (before.clip is not None or not recording)) or not known.issuperset(
        clip_of(after).tracks
    ):
        return after  # nothing to set, or an edit of the keys themselves
    clip = clip_of(after)
    changed = False
    tracked = {(track.layer, track.field) for track in clip.tracks}
    for layer in after.stack:
        if layer.name not in before.stack.names or before.stack[layer.name] is layer:
            continue
        for field in keyable(layer):
            if recording or (layer.name, field) in tracked:
                old, new = value_of(before.stack[layer.name], field), value_of(layer, field)
                if new is not None and not _same(old, new):
                    clip, changed = with_key(clip, layer.name, field, time, new, old), True
    return replace(after, clip=clip) if changed else after


def with_key(
    clip: Clip, layer: str, field: str, time: float, value: Any, before: NDArray[np.float64] | None = None
) -> Clip:
    """The clip with a key, reached as the one that was there, or as is usual.

    Where it is the first of its value, and comes after the beginning, the beginning keeps the value before.
    """
    found = [track for track in clip.tracks if (track.layer, track.field) == (layer, field)]
    easings = [key.easing for track in found for key in track.keys if key.time == time]
    if not found and time > 0 and before is not None:
        clip = clip.key(layer, 0.0, {field: before})
    return clip.key(layer, time, {field: value}, easings[0] if easings else USUAL)


def keyable(layer: Layer) -> list[str]:
    """The values of a layer that can have keys, those that people look for first coming first."""
    deformer = layer.deformer
    tool = tool_of(deformer)
    try:
        fields = [field.name for field in kind_of(tool).fields]
    except PliantError:
        fields = []
    found = [name for name in fields if _is_plain(getattr(tool, name, None))]
    by_points = not hasattr(type(tool), "parameters") and not isinstance(tool, Affine)
    if by_points and (not layer.in_space or value_of(layer, "controls") is not None):
        found.insert(0, "controls")
    if layer.in_space and not isinstance(tool, Affine):
        found.append("frame")
    return [*found, "envelope", "muted"]


def value_of(layer: Layer, field: str) -> NDArray[np.float64] | None:
    """The value of a layer as a key holds it; None where it has none."""
    deformer = layer.deformer
    if field in ("envelope", "muted"):
        return np.asarray(getattr(layer, field), np.float64)
    if field == "frame":
        return np.asarray(deformer.frame.matrix if isinstance(deformer, Placed) else np.eye(4))
    if field == "controls":
        try:
            return np.asarray(deformer.controls, np.float64)
        except (PliantError, TypeError, ValueError):
            return None  # an edit of a surface that has no goal yet
    value = getattr(tool_of(deformer), field, None)
    return None if value is None else np.asarray(value, np.float64)


def _is_plain(value: Any) -> bool:
    """Whether a field changes in proportion, and is small enough to be looked at."""
    if isinstance(value, np.ndarray):
        return bool(value.dtype.kind == "f") and value.size <= _MOST_NUMBERS
    if isinstance(value, tuple):
        return bool(value) and all(isinstance(item, float) for item in value)
    return isinstance(value, float)


def _same(old: NDArray[np.float64] | None, new: NDArray[np.float64]) -> bool:
    return old is not None and old.shape == new.shape and bool((old == new).all())
