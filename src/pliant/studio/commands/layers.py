"""Layers: added, removed, reordered, muted, renamed; their strength and their deformer's fields."""

from __future__ import annotations

import numpy as np

from pliant.errors import InvalidParameter
from pliant.scene.kinds import all_kinds
from pliant.scene.stack import Stack
from pliant.space.bezier_ffd import BezierFFD
from pliant.space.bspline_ffd import BSplineFFD
from pliant.studio.modes.lattices import principal_axes
from pliant.studio.modes.layering import with_fields, with_layer
from pliant.studio.request import Request, command
from pliant.studio.seen.parts import vertices_of
from pliant.studio.seen.titles import titled
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session

MOST_CONTROLS = 100_000


@command("layers.add")
def add(session: Session, request: Request) -> Frame:
    """A deformer of a kind, laid around the shape as it is now."""
    scene, name = session.required, request.text("kind")
    kinds = all_kinds()
    if name not in kinds or not kinds[name].makers:
        raise InvalidParameter(f"a {name!r} cannot be laid around a shape")
    kind = kinds[name]
    maker = "around" if "around" in kind.makers else next(iter(kind.makers))
    shape = scene.mesh.with_points(session.shown.binding.result)
    fields = request.names("fields") if "fields" in request.values else {}
    stack, layer = with_layer(scene.stack, titled(name), kind.around(shape, fields, maker))
    session.commit(scene.replace(stack=stack), "add", layer)
    return Frame({"layer": layer})


@command("lattice.add")
def lattice(session: Session, request: Request) -> Frame:
    """A lattice around the shape as it is now, or around a part of it."""
    scene = session.required
    points, part = session.shown.binding.result, request.text("part", "")
    points = points[vertices_of(scene, part)] if part else points
    shape = tuple(int(count) for count in request.several("shape", 3))
    if any(count < 1 for count in shape) or np.prod(shape, dtype=float) > MOST_CONTROLS:
        raise InvalidParameter(f"a lattice has 1 to {MOST_CONTROLS:,} control points; asked for {shape}")
    axes = principal_axes(points) if request.text("orientation", "axes") == "shape" else None
    margin = request.number("margin", 0.0)
    if request.text("basis") == "bezier":
        made: BSplineFFD | BezierFFD = BezierFFD.around(points, shape=shape, margin=margin, axes=axes)  # type: ignore[arg-type]
    else:
        made = BSplineFFD.around(points, shape=shape, margin=margin, axes=axes)  # type: ignore[arg-type]
    stack, layer = with_layer(scene.stack, "Lattice", made)
    session.commit(scene.replace(stack=stack), "add", layer)
    return Frame({"layer": layer})


@command("layers.remove")
def remove(session: Session, request: Request) -> None:
    """Without a layer."""
    _commit(session, session.required.stack.remove(request.text("layer")), "remove", request.text("layer"))


@command("layers.mute")
def mute(session: Session, request: Request) -> None:
    """Leave a layer out, or not."""
    stack = session.required.stack.replace(request.text("layer"), muted=request.truth("muted"))
    _commit(session, stack, "mute", request.text("layer"))


@command("layers.solo")
def solo(session: Session, request: Request) -> None:
    """Leave the others out, or not."""
    stack = session.required.stack.replace(request.text("layer"), solo=request.truth("solo"))
    _commit(session, stack, "solo", request.text("layer"))


@command("layers.rename")
def rename(session: Session, request: Request) -> None:
    """Another name."""
    old, new = request.text("layer"), request.text("name").strip()
    stack = session.required.stack.rename(old, new)
    if old in session.locked:
        session.locked[new] = session.locked.pop(old)
    scene = session.required
    clip = None if scene.clip is None else scene.clip.renamed(old, new, stack)
    session.commit(scene.replace(stack=stack, clip=clip), "rename", new)


@command("layers.move")
def move(session: Session, request: Request) -> None:
    """To another place, 0 being the first that deforms."""
    stack = session.required.stack.move(request.text("layer"), request.integer("index"))
    _commit(session, stack, "move", request.text("layer"))


@command("layers.envelope")
def envelope(session: Session, request: Request) -> None:
    """How much of it there is."""
    stack = session.required.stack.replace(request.text("layer"), envelope=request.number("envelope"))
    _commit(session, stack, "envelope", request.text("layer"))


@command("layers.fields")
def fields(session: Session, request: Request) -> None:
    """Other fields of the deformer."""
    stack, name = session.required.stack, request.text("layer")
    deformer = with_fields(stack[name].deformer, request.names("fields"))
    _commit(session, stack.replace(name, deformer=deformer), "field", name)


def _commit(session: Session, stack: Stack, key: str, subject: str) -> None:
    session.drop_drag()
    session.commit(session.required.replace(stack=stack), key, subject)
