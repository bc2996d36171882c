"""Control points in numbers: fetched, set, reset, locked."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Controls, Deformer
from pliant.errors import InvalidParameter
from pliant.rendering.palette import SEQUENTIAL, color_table
from pliant.scene.keyed import tool_of
from pliant.space.smooth_dragging import has_joints
from pliant.studio.modes.lattices import axes_of, links, places_around
from pliant.studio.modes.placements import to_frame, to_world
from pliant.studio.request import Request, command
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session


@command("points.get", reads=True)
def get(session: Session, request: Request) -> Frame:
    """Where the control points of a layer rest and are, which are neighbours, which are locked."""
    name = request.text("layer")
    deformer = _by_points(session, name)
    arrays: dict[str, NDArray[Any]] = {
        "rest": to_world(deformer, deformer.rest.reshape(-1, 3)).reshape(-1),
        "points": to_world(deformer, deformer.controls.reshape(-1, 3)).reshape(-1),
        "links": links(deformer).reshape(-1),
        "axes": axes_of(deformer).reshape(-1),
        "locked": session.locked_points(name),
    }
    around = places_around(deformer)
    if around is not None:
        arrays["places"] = around.reshape(-1)
    return Frame({"joints": has_joints(tool_of(deformer))}, arrays)


@command("points.influence", reads=True)
def influence(session: Session, request: Request) -> Frame:
    """How much of the control points' common move each point of the shape makes, from 0 to 1."""
    name = request.text("layer")
    deformer = _by_points(session, name)
    step = np.zeros(deformer.rest.shape)
    step.reshape(-1, 3)[request.indices("index", step.size // 3), 0] = 1.0
    share = session.shown.binding.bound(name).jvp(None, step)[:, 0]
    table = np.rint(255 * color_table(SEQUENTIAL)).astype(np.uint8)
    return Frame({}, {"values": share.astype(np.float32), "table": table})


@command("points.set")
def put(session: Session, request: Request) -> None:
    """Put control points at positions."""
    name = request.text("layer")
    deformer = _by_points(session, name)
    controls = np.array(deformer.controls)
    flat = controls.reshape(-1, 3)
    index, positions = request.indices("index", len(flat)), request.points("positions")
    if len(index) != len(positions):
        raise InvalidParameter(f"{len(index)} control points have {len(positions)} positions")
    _refuse_locked(session, name, index.tolist())
    flat[index] = to_frame(deformer, positions)
    _commit(session, name, deformer, controls, "points")


@command("points.reset")
def reset(session: Session, request: Request) -> None:
    """Put control points, or all, back to where they rest."""
    name = request.text("layer")
    deformer = _by_points(session, name)
    controls = np.array(deformer.controls)
    flat, rest = controls.reshape(-1, 3), deformer.rest.reshape(-1, 3)
    chosen = request.indices("index", len(flat)) if "index" in request.arrays else np.arange(len(flat))
    free = np.setdiff1d(chosen, session.locked_points(name))
    flat[free] = rest[free]
    _commit(session, name, deformer, controls, "reset")


@command("points.lock")
def lock(session: Session, request: Request) -> None:
    """Lock control points, or unlock them."""
    name = request.text("layer")
    chosen = request.indices("index", _by_points(session, name).controls.size // 3).tolist()
    locked = session.locked.setdefault(name, set())
    if request.truth("locked"):
        locked.update(chosen)
    else:
        locked.difference_update(chosen)
    session.tell_scene()


def _by_points(session: Session, name: str) -> Deformer:
    """The deformer of a layer whose controls are positions."""
    layer = session.required.stack[name]
    if not layer.in_space or layer.deformer.controls.ndim < 2:
        raise InvalidParameter(f"layer {name!r} has no control points")
    return layer.deformer


def _refuse_locked(session: Session, name: str, chosen: list[int]) -> None:
    locked = session.locked.get(name, set())
    held = [each for each in chosen if each in locked]
    if held:
        raise InvalidParameter(f"control point {held[0]} is locked: unlock it first")


def _commit(session: Session, name: str, deformer: Deformer, controls: Controls, key: str) -> None:
    session.drop_drag()
    stack = session.required.stack.replace(name, deformer=deformer.moved(controls))
    session.commit(session.required.replace(stack=stack), key, name)
