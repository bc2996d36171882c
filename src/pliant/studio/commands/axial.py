"""Handles of deformers along an axis: shown, dragged; the tool fitted to the shape."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import Points
from pliant.scene.keyed import tool_of
from pliant.scene.stack import Stack
from pliant.space.axes import unit_axis
from pliant.space.axial import AxialDeformer
from pliant.space.tangent_frames import TangentFrames
from pliant.studio.dragging import Dragging, begin, cancel, commit, ongoing
from pliant.studio.modes.axial.following import Ray, followed, snapped
from pliant.studio.modes.axial.ghost import ghost
from pliant.studio.modes.axial.handle import Handle
from pliant.studio.modes.axial.handles import handles_of
from pliant.studio.modes.axial.tool import Tool, exchanged, holds, tool_on
from pliant.studio.modes.placements import to_frame
from pliant.studio.request import Client, Request, command
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session

_PARALLEL = 0.05


class HandleDrag(Dragging):
    """A handle follows the pointer."""

    def __init__(self, session: Session, client: Client, layer: str, name: str) -> None:
        super().__init__(session, client, layer, "handle")
        self._binding = session.shown.binding
        self._start = self._binding.stack
        self._tool = _tool(session, self._start, layer)
        self._handle = _named(self._tool, name)

    def move(self, request: Request) -> tuple[NDArray[np.integer], Points, dict[str, NDArray[Any]]]:
        eye, direction = np.split(request.numbers("ray", 6), 2)
        self._tool = followed(self._tool, self._handle, Ray(eye, unit_axis(direction)))
        shown = snapped(self._tool, self._handle) if request.truth("snap") else self._tool
        before = self._binding.result
        self._binding = self._binding.updated(
            self._start.replace(self.layer, deformer=exchanged(self._start[self.layer], shown.deformer))
        )
        points = self._binding.result
        return np.flatnonzero((points != before).any(axis=1)), points, _arrays(shown)

    @property
    def stack(self) -> Stack:
        return self._binding.stack


@command("axial.get")
def get(session: Session, request: Request) -> Frame:
    """The handles of a layer, and the lines around its axis."""
    stack = session.required.stack if session.dragging is None else session.dragging.stack
    tool = _tool(session, stack, request.text("layer"))
    return Frame({"handles": [{"name": each.name, "unit": each.unit} for each in handles_of(tool)]}, _arrays(tool))


@command("axial.begin")
def start(session: Session, request: Request) -> None:
    """Take hold of a handle."""
    begin(HandleDrag(session, request.client, request.text("layer"), request.text("handle")), session)


@command("axial.move")
def move(session: Session, request: Request) -> Frame:
    """The handle is where the pointer is."""
    return ongoing(session, request).preview(request)


command("axial.commit")(commit)
command("axial.cancel")(cancel)


@command("axial.fit")
def fit(session: Session, request: Request) -> None:
    """Lay a layer's axis through the middle of the shape that it is given, and its bounds around it."""
    name = request.text("layer")
    stack = session.required.stack
    layer = stack[name]
    if not holds(layer.deformer):
        raise InvalidParameter(f"layer {name!r} has no axis")
    deformer, given = tool_of(layer.deformer), to_frame(layer.deformer, session.shown.binding.below(name))
    if isinstance(deformer, AxialDeformer):
        turned = _along(deformer, request.text("axis")) if "axis" in request.values else deformer
        own = {key: getattr(turned, key) for key in ("axis", "normal") if hasattr(turned, key)}
        laid = type(deformer).around(given, **own)
        middle: dict[str, Any] = {"center": None} if hasattr(turned, "center") else {}
        fitted: Any = replace(turned, origin=laid.origin, bounds=laid.bounds, **middle)
    else:
        fitted = replace(deformer, origin=type(deformer).around(given).origin)  # type: ignore[attr-defined, type-var]
    session.drop_drag()
    session.commit(session.required.replace(stack=stack.replace(name, deformer=exchanged(layer, fitted))), "fit", name)


def _along(deformer: AxialDeformer, axis: str) -> AxialDeformer:
    """A deformer about another axis; a normal that would be parallel to it gives way."""
    normal = getattr(deformer, "normal", None)
    if normal is None or np.linalg.norm(np.cross(unit_axis(normal), unit_axis(axis))) > _PARALLEL:
        return replace(deformer, axis=axis)
    fields: dict[str, Any] = {"axis": axis, "normal": "zx"[axis == "z"]}
    return replace(deformer, **fields)


def _tool(session: Session, stack: Stack, layer: str) -> Tool:
    if not holds(stack[layer].deformer):
        raise InvalidParameter(f"layer {layer!r} has no axis to take hold of")
    return tool_on(stack, layer, session.shown.binding.below(layer))


def _named(tool: Tool, name: str) -> Handle:
    found = [each for each in handles_of(tool) if each.name == name]
    if not found:
        raise InvalidParameter(f"there is no handle {name!r}; there are: {', '.join(h.name for h in handles_of(tool))}")
    return found[0]


def _arrays(tool: Tool) -> dict[str, NDArray[Any]]:
    """Where the handles are, what they say, and the lines."""
    handles, lines = handles_of(tool), ghost(tool)
    rates = {"rates": np.array(tool.deformer.rates).reshape(-1)} if isinstance(tool.deformer, TangentFrames) else {}
    return rates | {
        "handles": np.concatenate([each.place(tool)[0] for each in handles]),
        "values": np.array([each.value(tool) for each in handles]),
        "before": lines.before.astype(np.float32).reshape(-1),
        "after": lines.after.astype(np.float32).reshape(-1),
        "offsets": lines.offsets,
    }
