"""What is drawn around the axis: a tube, a pond or a box, before the deformation and after."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points
from pliant.space.scale import Scale
from pliant.studio.modes.axial.tool import Tool

_RINGS = 7
_RULES = 8
_FINE = 48


@dataclass(frozen=True)
class Ghost:
    """Lines: (k, 3) points before and after the deformation, and where each line begins, with the end."""

    before: Points
    after: Points
    offsets: NDArray[np.uint32]


def ghost(tool: Tool) -> Ghost:
    """The lines of a tool."""
    if isinstance(tool.deformer, Scale):
        lines = _box(tool)
    elif tool.deformer.radial:
        lines = _pond(tool)
    else:
        lines = _tube(tool)
    before = np.concatenate(lines)
    offsets = np.concatenate([[0], np.cumsum([len(line) for line in lines])])
    return Ghost(tool.above(before), tool.carried(before), offsets.astype(np.uint32))


def _tube(tool: Tool) -> list[Points]:
    angle, steps = np.linspace(0, 2 * np.pi, _FINE + 1), np.linspace(0, 1, _FINE + 1)
    rings = [tool.at(np.cos(angle), np.sin(angle), tool.between(t)) for t in np.linspace(0, 1, _RINGS)]
    rules = [tool.at(np.cos(a), np.sin(a), tool.between(steps)) for a in angle[:-1][:: _FINE // _RULES]]
    return [*rings, *rules, tool.at(0.0, 0.0, tool.between(steps))]


def _pond(tool: Tool) -> list[Points]:
    angle, level = np.linspace(0, 2 * np.pi, _FINE + 1), tool.origin @ tool.along
    distances = tool.between(np.linspace(0, 1, 2 * _RINGS + 1)) / tool.size
    rings = [tool.at(d * np.cos(angle), d * np.sin(angle), level) for d in distances]
    fine = tool.between(np.linspace(0, 1, 2 * _FINE + 1)) / tool.size
    return [*rings, *(tool.at(fine * np.cos(a), fine * np.sin(a), level) for a in angle[:-1][:: _FINE // _RULES])]


def _box(tool: Tool) -> list[Points]:
    corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) * tool.size
    pairs = [(a, b) for a in range(8) for b in range(a + 1, 8) if (a ^ b).bit_count() == 1]
    return [tool.origin + corners[[a, b]] @ tool.axes.T for a, b in pairs]
