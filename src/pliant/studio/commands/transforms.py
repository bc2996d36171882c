"""Deformations from files: what was found in them, where their lattice lies, and taking them into the stack."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidParameter, PliantWarning
from pliant.io.transforms import read_transform
from pliant.scene.kinds import kind_of
from pliant.studio.commands.opening import main_file
from pliant.studio.modes.lattices import lattice_shape, links
from pliant.studio.modes.layering import with_layer
from pliant.studio.request import Request, command
from pliant.studio.seen.titles import titled
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session


@command("transform.preview", reads=True)
def preview(session: Session, request: Request) -> Frame:
    """What a file holds, under the choices made so far, and what it would do to the mesh."""
    found, told = _read(session, request)
    mesh = session.required.mesh
    reach = float(np.linalg.norm(found(mesh.points) - mesh.points, axis=1).max(initial=0.0))
    head: dict[str, Any] = {"summary": _summary(found), "warnings": told, "reach": reach, "inside": 1.0}
    if lattice_shape(found) is None:
        return Frame(head)
    corners = found.rest.reshape(-1, 3)
    head["inside"] = _part_inside(mesh.points, found)
    return Frame(head, {"points": corners.reshape(-1), "links": links(found).reshape(-1)})


@command("transform.import")
def take(session: Session, request: Request) -> Frame:
    """As a new layer; or as the displacements of a lattice of the same size."""
    found, _ = _read(session, request)
    scene, into = session.required, request.text("into", "")
    if into:
        own, theirs = scene.stack[into].deformer.controls, found.controls
        if own.shape != theirs.shape:
            sizes = " and ".join(" × ".join(map(str, each.shape[:-1])) for each in (theirs, own))
            raise InvalidParameter(
                f"the file and the lattice of {into!r} have different numbers of control points, {sizes}: "
                "take the file as a new layer, or make a lattice of its size"
            )
        moved = scene.stack[into].deformer
        deformer = moved.moved(moved.rest + theirs - found.rest)
        stack, layer = scene.stack.replace(into, deformer=deformer), into
    else:
        stack, layer = with_layer(scene.stack, _name(session, request), found)
    session.commit(scene.replace(stack=stack), "import", layer)
    return Frame({"layer": layer})


def _read(session: Session, request: Request) -> tuple[SpaceDeformer, list[str]]:
    """The deformer of an uploaded file, and what had to be guessed."""
    upload = session.uploads.get(request.text("upload"))
    path = main_file([upload.path(at) for at in range(len(upload.names))])
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", PliantWarning)
        found = read_transform(
            path,
            placement=request.text("placement", "physical"),  # type: ignore[arg-type]
            variant=request.text("variant", "") or None,  # type: ignore[arg-type]
            edge=request.text("edge", "clamp"),  # type: ignore[arg-type]
            target=session.required.mesh,
        )
    told = [str(each.message).replace(str(path), path.name) for each in caught if each.category is PliantWarning]
    return found, told


def _name(session: Session, request: Request) -> str:
    return session.uploads.get(request.text("upload")).names[0].rsplit(".", 1)[0]


def _summary(found: SpaceDeformer) -> str:
    shape = lattice_shape(found)
    size = "" if shape is None else f", {' × '.join(map(str, shape))}"
    direction = getattr(found, "direction", None)
    return f"{titled(kind_of(found).name)}{size}{f', {direction}' if direction else ''}"


def _part_inside(points: np.ndarray[Any, np.dtype[np.float64]], found: SpaceDeformer) -> float:
    """How much of the mesh lies in the box of a lattice's control points, measured along its own axes."""
    from pliant.studio.modes.lattices import axes_of

    axes = axes_of(found)
    corners = found.rest.reshape(-1, 3) @ axes
    own = points @ axes
    inside = ((own >= corners.min(axis=0)) & (own <= corners.max(axis=0))).all(axis=1)
    return float(inside.mean()) if len(inside) else 0.0
