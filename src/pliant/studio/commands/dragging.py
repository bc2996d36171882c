"""Drags: of control points, of a point of the surface, of a slider."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import Points
from pliant.scene.keyed import tool_of
from pliant.scene.stack import Stack
from pliant.scene.stack_binding import StackBinding
from pliant.space.direct import pull as pulled
from pliant.space.smooth_dragging import SmoothDrag
from pliant.studio.dragging import Dragging, begin, cancel, commit, ongoing
from pliant.studio.modes.layering import with_fields
from pliant.studio.modes.placements import to_frame, to_world
from pliant.studio.request import Client, Request, command
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session


class PointsDrag(Dragging):
    """Control points follow the pointer."""

    def __init__(self, session: Session, client: Client, layer: str) -> None:
        super().__init__(session, client, layer, "drag")
        self._deformer = session.required.stack[layer].deformer
        self._drag = session.shown.binding.drag_layer(layer)
        self._controls = self._drag.controls
        if self._controls.ndim < 2 or self._controls.shape[-1] != 3:
            raise InvalidParameter(f"layer {layer!r} has no control points: change its fields")
        self._locked = set(session.locked_points(layer).tolist())
        self._smooth: tuple[NDArray[np.int64], SmoothDrag] | None = None

    def move(self, request: Request) -> tuple[NDArray[np.integer], Points, dict[str, NDArray[Any]]]:
        flat = self._controls.reshape(-1, 3)
        index, positions = request.indices("index", len(flat)), request.points("positions")
        if len(index) != len(positions):
            raise InvalidParameter(f"{len(index)} control points have {len(positions)} positions")
        free = [at for at, point in enumerate(index.tolist()) if point not in self._locked]
        index, positions = index[free], to_frame(self._deformer, positions[free])
        if "smooth" in request.values and request.truth("smooth") and len(index):
            return self._move_smoothly(flat, index, positions)
        flat[index] = positions
        changed = np.stack(np.unravel_index(index, self._controls.shape[:-1]), axis=-1)
        touched = self._drag.update(self._controls, changed)
        return touched, self._drag.points, {}

    def _move_smoothly(
        self, flat: Points, index: NDArray[np.int64], positions: Points
    ) -> tuple[NDArray[np.integer], Points, dict[str, NDArray[Any]]]:
        """Take along what keeps the joints of patches smooth, but for what is locked; pages are told where it goes."""
        if self._smooth is None or not np.array_equal(self._smooth[0], index):
            self._smooth = index, SmoothDrag(tool_of(self._deformer), index)
        locked = sorted(self._locked)
        kept = flat[locked]
        flat[:] = self._smooth[1].controls(positions)
        flat[locked] = kept
        touched = self._drag.update(self._controls)
        return touched, self._drag.points, {"controls": to_world(self._deformer, flat).reshape(-1)}

    @property
    def stack(self) -> Stack:
        return self._drag.stack


class Pull(Dragging):
    """A point of the surface follows the pointer, and the controls what it needs."""

    def __init__(self, session: Session, client: Client, layer: str, corners: list[int], grip: Points) -> None:
        super().__init__(session, client, layer, "pull")
        stage = session.shown
        stack = stage.scene.stack
        chosen = stack[layer]
        if chosen.muted or layer not in [each.name for each in stack.active]:
            raise InvalidParameter(f"layer {layer!r} is left out: unmute it to pull at it")
        if stack.active[-1].name != layer or chosen.envelope != 1.0 or chosen.mask is not None:
            raise InvalidParameter(f"only the topmost layer, at full strength, can be pulled: move {layer!r} there")
        weights = _barycentric(stage.binding.result[corners], grip)
        self._at = (weights @ stage.binding.below(layer)[corners])[None]
        self._deformer = chosen.deformer
        self._offset = grip - self._deformer(self._at)[0]  # between corners the map is not quite linear
        locked = session.locked_points(layer)
        shape = chosen.deformer.rest.shape[:-1]
        self._frozen = np.stack(np.unravel_index(locked, shape), axis=-1) if len(locked) else None
        self._drag = stage.binding.drag_layer(layer)

    def move(self, request: Request) -> tuple[NDArray[np.integer], Points, dict[str, NDArray[Any]]]:
        goal = request.points("goal") - self._offset
        controls = pulled(self._deformer, self._at, goal, frozen=self._frozen).controls
        touched = self._drag.update(controls)
        return touched, self._drag.points, {"controls": controls.reshape(-1)}

    @property
    def stack(self) -> Stack:
        return self._drag.stack


class Sliding(Dragging):
    """A slider sets the strength of a layer, or a field of its deformer."""

    def __init__(self, session: Session, client: Client, layer: str, key: str) -> None:
        super().__init__(session, client, layer, key)
        self._binding: StackBinding = session.shown.binding
        self._stack, self._start = self._binding.stack, self._binding.stack

    def move(self, request: Request) -> tuple[NDArray[np.integer], Points, dict[str, NDArray[Any]]]:
        layer = self._start[self.layer]
        if "envelope" in request.values:
            layer = replace(layer, envelope=request.number("envelope"))
        if "fields" in request.values:
            layer = replace(layer, deformer=with_fields(layer.deformer, request.names("fields")))
        self._stack = self._start.replace(self.layer, envelope=layer.envelope, deformer=layer.deformer)
        before = self._binding.result
        self._binding = self._binding.updated(self._stack)
        points = self._binding.result
        return np.flatnonzero((points != before).any(axis=1)), points, {}

    @property
    def stack(self) -> Stack:
        return self._stack


@command("drag.begin")
def drag(session: Session, request: Request) -> None:
    """Take hold of control points."""
    begin(PointsDrag(session, request.client, request.text("layer")), session)


@command("pull.begin")
def pull(session: Session, request: Request) -> None:
    """Take hold of a point of the surface: of a triangle, nearest to a position."""
    corners = [int(vertex) for vertex in request.several("triangle", 3)]
    count = len(session.required.mesh.points)
    if not all(0 <= vertex < count for vertex in corners):
        raise InvalidParameter(f"the triangle {corners} is none of this mesh")
    point = np.asarray(request.several("point", 3), np.float64)
    begin(Pull(session, request.client, request.text("layer"), corners, point), session)


@command("preview.begin")
def preview(session: Session, request: Request) -> None:
    """Take hold of a slider."""
    begin(Sliding(session, request.client, request.text("layer"), request.text("label", "field")), session)


def _move(session: Session, request: Request) -> Frame:
    return ongoing(session, request).preview(request)


for _kind in ("drag", "pull", "preview"):
    command(f"{_kind}.move")(_move)
    command(f"{_kind}.commit")(commit)
    command(f"{_kind}.cancel")(cancel)


def _barycentric(corners: Points, point: Points) -> Points:
    """(3,) weights of the corners of a triangle whose sum is nearest to a point of its plane."""
    sides = np.stack([corners[1] - corners[0], corners[2] - corners[0]], axis=1)
    (v, w), *_ = np.linalg.lstsq(sides, point - corners[0], rcond=None)
    return np.array([1 - v - w, v, w])
