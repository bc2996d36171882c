"""Moving a tool as a whole: its origin, its axis, its normal. What belongs to the axis goes along."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.space.axes import unit_axis
from pliant.space.axial import AxialDeformer
from pliant.space.bend import Bend
from pliant.studio.modes.axial.tool import Tool

Floats = NDArray[np.float64]

_LEVEL = 1e-9  # a direction that is this near to a coordinate axis is called by its name


def moved_to(tool: Tool, origin: Floats) -> Tool:
    """The tool with its (3,) origin elsewhere; its bounds move along."""
    if not isinstance(tool.deformer, AxialDeformer):
        return tool.having(origin=origin)
    return tool.having(origin=origin, **_measured(tool, float((origin - tool.origin) @ tool.along)))


def turned_to(tool: Tool, tip: Floats) -> Tool:
    """The tool turned about its origin, so that its axis points to a tip (3,), seen from there."""
    along = unit_axis(tip)
    turn = _shortest_turn(tool.along, along)
    fields: dict[str, Any] = {
        name: _called(turn @ unit_axis(value))
        for name in ("axis", "normal")
        if (value := getattr(tool.deformer, name, None)) is not None
    }
    return tool.having(**fields, **_measured(tool, float(tool.origin @ (along - tool.along))))


def rolled_to(tool: Tool, tip: Floats) -> Tool:
    """The tool turned about its axis, so that its normal points to a tip (3,), seen from the origin."""
    along = tool.along
    across = tip - (tip @ along) * along
    if np.linalg.norm(across) < _LEVEL * tool.size:
        return tool
    normal = unit_axis(across)
    if isinstance(tool.deformer, Bend):
        return tool.having(normal=_called(normal), axis=_called(np.cross(along, normal)))
    return tool.having(normal=_called(normal))


def _measured(tool: Tool, shift: float) -> dict[str, Any]:
    """Positions along the axis, after it has been shifted."""
    if tool.deformer.radial:
        return {}
    low, high = tool.deformer.bounds
    found: dict[str, Any] = {"bounds": (low + shift, high + shift)}
    if getattr(tool.deformer, "center", None) is not None:
        found["center"] = tool.deformer.center + shift
    return found


def _called(direction: Floats) -> Any:
    """``"x"``, ``"y"`` or ``"z"`` where it is one of these, else the direction itself."""
    at = int(direction.argmax())
    return "xyz"[at] if np.abs(direction - np.eye(3)[at]).max() < _LEVEL else direction


def _shortest_turn(start: Floats, end: Floats) -> Floats:
    """(3, 3) the rotation by the least angle from one unit vector to another."""
    cosine = float(start @ end)
    if cosine < -0.5:  # half a turn first, and then what is missing: exact, however near to half a turn it is
        across = _across(start, end)
        half = 2 * np.outer(across, across) - np.eye(3)
        return np.asarray(_shortest_turn(-start, end) @ half)
    axis = np.cross(start, end)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / (1 + cosine))


def _across(start: Floats, end: Floats) -> Floats:
    """(3,) a unit vector at right angles to two; to the first, and any, where they lie on one line."""
    across = np.cross(start, end)
    if np.linalg.norm(across) < _LEVEL:
        across = np.cross(start, np.eye(3)[np.abs(start).argmin()])
    across = across - (across @ start) * start
    return np.asarray(across / np.linalg.norm(across))
