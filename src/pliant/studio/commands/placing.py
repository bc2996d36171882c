"""Placing: a tool is moved over the object by hand, or the object through the tool, each place being a key in time."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidDeformer, InvalidParameter
from pliant.mesh import Points
from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.space.affine import Affine
from pliant.studio.dragging import Dragging, begin, cancel, commit, ongoing
from pliant.studio.modes.layering import free_name
from pliant.studio.modes.placements import frame_field, frame_of, framed, pivot_of, way_of
from pliant.studio.modes.posing import clip_of, with_key
from pliant.studio.request import Client, Request, command
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session


class Placing(Dragging):
    """A layer as a whole follows the gizmo: what has happened to it is a map of space."""

    def __init__(self, session: Session, client: Client, layer: str) -> None:
        super().__init__(session, client, layer, "place")
        self._binding = session.shown.binding
        self._start = self._stack = self._binding.stack
        frame_field(self._start[layer])

    def move(self, request: Request) -> tuple[NDArray[np.integer], Points, dict[str, NDArray[Any]]]:
        layer = self._start[self.layer]
        placed = framed(layer, _matrix(request) @ frame_of(layer))
        self._stack = self._start.replace(self.layer, deformer=placed.deformer)
        self._binding = self._binding.updated(self._stack)
        points = self._binding.result
        return np.arange(len(points)), points, {}

    @property
    def stack(self) -> Stack:
        return self._stack

    @property
    def scene(self) -> Scene:
        """With a key of the new place at the playhead."""
        session, layer = self._session, self._stack[self.layer]
        before = frame_of(self._start[self.layer])
        scene = session.required.replace(stack=self._stack)
        clip = with_key(clip_of(scene), layer.name, frame_field(layer), session.time, frame_of(layer), before)
        return scene.replace(clip=clip)


@command("place.get", reads=True)
def get(session: Session, request: Request) -> Frame:
    """Where a layer stands, and the way that it takes through the clip."""
    scene = session.required
    layer, shape = scene.stack[request.text("layer")], scene.mesh.points
    if not layer.in_space:
        return Frame({"placeable": False})
    pivot = (frame_of(layer) @ np.append(pivot_of(layer, shape), 1.0))[:3]
    along, keys = way_of(clip_of(scene), layer.name, shape)
    head = {"placeable": True, "object": isinstance(layer.deformer, Affine), "pivot": pivot.tolist()}
    return Frame(head, {"way": along.reshape(-1), "keys": keys.reshape(-1)})


@command("place.through")
def through(session: Session, request: Request) -> Frame:
    """A layer below another that moves the object, through the tool that this one is."""
    stack = session.required.stack
    index = stack.index(request.text("layer"))
    name = free_name("Object", stack.names)
    layers = [*stack.layers[:index], Layer(name, Affine()), *stack.layers[index:]]
    session.drop_drag()
    session.commit(session.required.replace(stack=Stack(tuple(layers), stack.mode)), "add", name)
    return Frame({"layer": name})


@command("place.begin")
def take(session: Session, request: Request) -> None:
    """Take hold of a layer as a whole."""
    begin(Placing(session, request.client, request.text("layer")), session)


@command("place.move")
def move(session: Session, request: Request) -> Frame:
    """Move it: by the map of space from where it was taken."""
    return ongoing(session, request).preview(request)


command("place.commit")(commit)
command("place.cancel")(cancel)


def _matrix(request: Request) -> NDArray[np.float64]:
    try:
        return Affine(np.array(request.several("matrix", 16), np.float64).reshape(4, 4)).matrix
    except (TypeError, ValueError, InvalidDeformer) as error:
        raise InvalidParameter(f"the gizmo's matrix is none: {error}") from error
