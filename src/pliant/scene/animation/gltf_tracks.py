"""The keys of a glTF's animation: how a node's place, turn, size or weights change over time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter, UnreadableFile
from pliant.io.mesh_formats.gltf_file import GltfFile, item

Floats = NDArray[np.float64]
Which = str | int

_EVEN = 0.9995  # quaternions whose cosine is larger are mixed evenly


@dataclass(frozen=True, eq=False)
class Track:
    """Values over time.

    Parameters
    ----------
    times
        (k,) seconds.
    values
        (k, d), or (k, 3, d) of splines: the tangent before each value, the value, the tangent after it.
    how
        ``"STEP"``, ``"LINEAR"`` or ``"CUBICSPLINE"``.
    turning
        Whether they are quaternions.
    """

    times: Floats
    values: Floats
    how: str
    turning: bool

    @property
    def straight(self) -> bool:
        """Whether points move along straight lines between keys."""
        return self.how == "LINEAR" and not self.turning

    def at(self, time: float) -> Floats:
        """(d,) the value at a time; before the first key and after the last it stays."""
        place = float(np.interp(time, self.times, np.arange(len(self.times))))
        first = min(int(place), len(self.times) - 1)
        part = place - first
        kept = self.values[:, 1] if self.how == "CUBICSPLINE" else self.values
        if part == 0 or self.how == "STEP":
            return np.asarray(kept[first])
        if self.how == "CUBICSPLINE":
            found = self._spline(first, part)
            return found / (np.linalg.norm(found) or 1.0) if self.turning else found
        if self.turning:
            return _slerp(kept[first], kept[first + 1], part)
        return np.asarray((1 - part) * kept[first] + part * kept[first + 1])

    def _spline(self, first: int, t: float) -> Floats:
        """Hermite's cubic between two keys (glTF 2.0, appendix C.5)."""
        span = self.times[first + 1] - self.times[first]
        (_, start, leaving), (arriving, end, _) = self.values[first], self.values[first + 1]
        return np.asarray(
            (2 * t**3 - 3 * t**2 + 1) * start
            + span * (t**3 - 2 * t**2 + t) * leaving
            + (3 * t**2 - 2 * t**3) * end
            + span * (t**3 - t**2) * arriving
        )


def tracks_of(file: GltfFile, which: Which) -> dict[tuple[int, str], Track]:
    """The tracks of an animation, given by its name or number, by node and path.

    Raises
    ------
    UnreadableFile
        The file holds no animation.
    InvalidParameter
        It holds none of that name or number.
    """
    animations = file.json.get("animations", [])
    if not animations:
        raise UnreadableFile(
            file.source.name, "it holds no animation", "read it as a mesh, or export it with its motion"
        )
    found: dict[tuple[int, str], Track] = {}
    chosen = _chosen(animations, which)
    for channel in chosen["channels"]:
        target = channel["target"]
        if "node" in target:
            found[target["node"], target["path"]] = _track(file, item(chosen["samplers"], channel["sampler"]), target)
    return found


def _chosen(animations: list[Any], which: Which) -> Any:
    names = [str(each.get("name", "")) for each in animations]
    if isinstance(which, str) and which in names:
        return animations[names.index(which)]
    if isinstance(which, int) and 0 <= which < len(animations):
        return animations[which]
    there = ", ".join(f"{i} {name!r}" if name else str(i) for i, name in enumerate(names))
    raise InvalidParameter(f"there is no animation {which!r}; there are: {there}")


def _track(file: GltfFile, sampler: dict[str, Any], target: dict[str, Any]) -> Track:
    how = sampler.get("interpolation", "LINEAR")
    times = file.values(sampler["input"])[:, 0].astype(np.float64)
    values: Floats = file.values(sampler["output"]).astype(np.float64).reshape(len(times), -1)
    if not len(times) or (np.diff(times) <= 0).any() or not np.isfinite(values).all():
        raise ValueError("keys that are not in order, or not finite")
    if how == "CUBICSPLINE":
        values = values.reshape(len(times), 3, -1)
    return Track(times, values, how, target["path"] == "rotation")


def _slerp(before: Floats, after: Floats, part: float) -> Floats:
    """From one unit quaternion to another, the shorter way round, at an even rate."""
    cosine = float(before @ after)
    if cosine < 0:
        after, cosine = -after, -cosine
    if cosine > _EVEN:
        found = (1 - part) * before + part * after
        return np.asarray(found / (np.linalg.norm(found) or 1.0))
    angle = np.arccos(cosine)
    return np.asarray((np.sin((1 - part) * angle) * before + np.sin(part * angle) * after) / np.sin(angle))
