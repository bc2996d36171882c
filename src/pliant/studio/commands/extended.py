"""Lattices of other shapes than boxes: cylinders, prisms, spheres around the shape or a part of it."""

from __future__ import annotations

from typing import Any

from pliant.errors import InvalidParameter
from pliant.space.extended_ffd import ExtendedFFD
from pliant.studio.modes.lattices import links
from pliant.studio.modes.layering import with_layer
from pliant.studio.request import Request, command
from pliant.studio.seen.parts import vertices_of
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session

MOST_CONTROLS = 20_000


@command("extended.preview", reads=True)
def preview(session: Session, request: Request) -> Frame:
    """What the lattice would look like."""
    made = _made(session, request)
    return Frame({"count": len(made.points)}, {"points": made.rest.reshape(-1), "links": links(made).reshape(-1)})


@command("extended.add")
def add(session: Session, request: Request) -> Frame:
    """A round lattice around the shape as it is now, or around a part of it."""
    scene = session.required
    stack, layer = with_layer(scene.stack, request.text("kind").capitalize(), _made(session, request))
    session.commit(scene.replace(stack=stack), "add", layer)
    return Frame({"layer": layer})


def _made(session: Session, request: Request) -> ExtendedFFD:
    scene = session.required
    points, part = session.shown.binding.result, request.text("part", "")
    target: Any = points[vertices_of(scene, part)] if part else points
    kind, axis, margin = request.text("kind"), request.text("axis"), request.number("margin", 0.05)
    around, outwards, along = request.numbers("shape", 3).astype(int).tolist()
    if around * outwards * along > MOST_CONTROLS:
        raise InvalidParameter(f"that lattice has more than {MOST_CONTROLS:,} control points: take fewer")
    if kind == "cylinder":
        return ExtendedFFD.cylinder(target, axis, (around, outwards, along), margin)
    if kind == "prism":
        return ExtendedFFD.prism(target, axis, around, (outwards, along), margin)
    if kind == "sphere":
        return ExtendedFFD.sphere(target, axis, (around, outwards, along), margin)
    raise InvalidParameter(f"a round lattice is a cylinder, a prism or a sphere, not {kind!r}")
