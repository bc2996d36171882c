"""A handle follows the pointer: the numbers at which its place lies nearest to the ray under the pointer.

Gauss-Newton from where the handle is now, with steps that are halved while they lead away or into what the deformer
refuses. A twist is followed through as many turns as the pointer makes, for each step begins at the last one's end.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.errors import PliantError
from pliant.studio.modes.axial.handle import Handle
from pliant.studio.modes.axial.tool import Tool

Floats = NDArray[np.float64]

_STEPS = 16
_HALVINGS = 10
_NEAR = 1e-10  # of the tool's size: near enough
_PROBE = 1e-5  # how far a derivative looks
_FLAT = 1e-4  # of a handle's reach: a direction in which it hardly moves, as seen from the eye, is left alone


@dataclass(frozen=True)
class Ray:
    """From the eye through the pointer: (3,) a point and a (3,) unit direction."""

    origin: Floats
    direction: Floats

    def miss(self, place: Floats) -> Floats:
        """(3,) from the ray to a place, at right angles."""
        offset = place - self.origin
        return np.asarray(offset - (offset @ self.direction) * self.direction)


def followed(tool: Tool, handle: Handle, ray: Ray) -> Tool:
    """The tool whose handle is as near to a ray as it gets."""
    reach = _reach(tool, handle)
    numbers, now = handle.read(tool), tool
    miss = ray.miss(handle.place(now)[0])
    for _ in range(_STEPS):
        step = _step(now, handle, ray, numbers, miss, reach)
        found = _shorter(tool, handle, ray, numbers, step, miss)
        if found is None:
            break
        gain = np.linalg.norm(miss) - np.linalg.norm(found[2])
        numbers, now, miss = found
        if gain < _NEAR * tool.size:
            break
    return now


def snapped(tool: Tool, handle: Handle) -> Tool:
    """The tool with a handle's numbers rounded: 15 degrees, a twentieth of a factor or of the size."""
    value = handle.read(tool)
    if handle.unit == "direction":
        length = np.linalg.norm(value)
        axes = np.concatenate([np.eye(3), -np.eye(3)])
        nearest = axes[np.argmax(axes @ value)]
        return handle.write(tool, nearest * length) if nearest @ value > np.cos(np.radians(12)) * length else tool
    step = {"radians": np.pi / 12, "factor": 0.05}.get(handle.unit, _round_step(tool.size / 20))
    try:
        return handle.write(tool, np.rint(value / step) * step)
    except PliantError:
        return tool


def _step(tool: Tool, handle: Handle, ray: Ray, numbers: Floats, miss: Floats, reach: Floats) -> Floats:
    slopes = np.zeros((3, len(numbers)))
    for at, unit in enumerate(reach):
        for side in (1.0, -1.0):
            ahead = numbers.copy()
            ahead[at] += side * _PROBE * unit
            try:
                moved = ray.miss(handle.place(handle.write(tool, ahead))[0])
            except PliantError:
                continue
            slopes[:, at] = (moved - miss) / (side * _PROBE)
            break
    step, *_ = np.linalg.lstsq(slopes, -miss, rcond=_FLAT)
    if np.linalg.norm(slopes) < _FLAT * tool.size:
        return np.zeros(len(numbers))
    return np.asarray(reach * step / max(1.0, np.abs(step).max()))


def _shorter(
    tool: Tool, handle: Handle, ray: Ray, numbers: Floats, step: Floats, miss: Floats
) -> tuple[Floats, Tool, Floats] | None:
    """A part of a step that leads nearer to the ray; None where there is none."""
    if not step.any():
        return None
    for halving in range(_HALVINGS):
        ahead = numbers + step / 2**halving
        try:
            moved = handle.write(tool, ahead)
            after = ray.miss(handle.place(moved)[0])
        except PliantError:
            continue
        if np.linalg.norm(after) < np.linalg.norm(miss):
            return ahead, moved, after
    return None


def _reach(tool: Tool, handle: Handle) -> Floats:
    """(k,) how far a handle's numbers go in one step."""
    unit = {"radians": 0.6, "factor": 0.5}.get(handle.unit, tool.size)
    return np.full(len(handle.read(tool)), unit)


def _round_step(length: float) -> float:
    """1, 2 or 5 times a power of ten, at most a length."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(power * max(part for part in (1, 2, 5) if part * power <= length * (1 + 1e-12)))
