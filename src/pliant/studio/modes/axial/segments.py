"""The handles of tangent frames: where each segment of the axis ends, and a rim at the end for all of the twist.

What is dragged is the end of a segment: the segment turns about the two directions across the axis, and grows or
shrinks where the pointer goes along it. What comes after goes along.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points
from pliant.studio.modes.axial.handle import Handle
from pliant.studio.modes.axial.tool import Tool

Floats = NDArray[np.float64]

_MOST = 16  # handles: of more segments, only some have one
_BENT = [0, 1, 3]  # what a segment's end is dragged by: two turns, and growth


def segment_handles(tool: Tool) -> tuple[Handle, ...]:
    """A handle for the end of each segment, called by its number, and one for the twist."""
    count = len(tool.deformer.rates)
    shown = np.unique(np.linspace(1, count, min(count, _MOST)).round().astype(int))
    ends = [
        Handle(f"#{at}", "radians", partial(_read, at), partial(_write, at), partial(_end, at), partial(_bend, at))
        for at in shown.tolist()
    ]
    return (*ends, Handle("twist", "radians", _twist, _twisted, _rim))


def _read(at: int, tool: Tool) -> Floats:
    return np.asarray(tool.deformer.rates[at - 1, _BENT])


def _write(at: int, tool: Tool, value: Floats) -> Tool:
    rates = np.array(tool.deformer.rates)
    rates[at - 1, _BENT] = value
    return tool.having(rates=rates)


def _end(at: int, tool: Tool) -> Points:
    return tool.carried(tool.at(0.0, 0.0, tool.between(at / len(tool.deformer.rates)))[None])


def _bend(at: int, tool: Tool) -> float:
    return float(np.hypot(*tool.deformer.rates[at - 1, :2]))


def _twist(tool: Tool) -> Floats:
    return np.asarray(tool.deformer.rates[:, 2].sum(keepdims=True))


def _twisted(tool: Tool, value: Floats) -> Tool:
    """All segments take an equal part of what is new."""
    rates = np.array(tool.deformer.rates)
    rates[:, 2] += (value[0] - rates[:, 2].sum()) / len(rates)
    return tool.having(rates=rates)


def _rim(tool: Tool) -> Points:
    return tool.carried(tool.at(1.0, 0.0, tool.between(1.0))[None])
