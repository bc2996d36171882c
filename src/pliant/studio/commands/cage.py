"""Cages: built in the background, by a budget or by planes; verified; their coordinates exchanged and compared."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from pliant.cages.checking import check_cage
from pliant.cages.constructing import Construction
from pliant.errors import InvalidParameter, NotConverged
from pliant.field.volumes import volume
from pliant.mesh import Points, PolygonMesh
from pliant.rendering.palette import SEQUENTIAL, color_table
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.scene.stack_binding import StackBinding
from pliant.space.cage import Cage
from pliant.space.coordinates.kinds import KINDS
from pliant.studio.jobs import Job
from pliant.studio.modes.caging import METHODS, Plan, plane_across, sketch, told
from pliant.studio.modes.layering import with_layer
from pliant.studio.request import Request, command
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session

MOST_VERTICES = 5000
_KEPT, _BESIDE = "cage-comparison", "cage-beside"


@command("cage.get", reads=True)
def get(session: Session, request: Request) -> Frame:
    """The faces of a cage, and which coordinates there are."""
    cage = _cage(session.required.stack, request.text("layer"))
    faces = cage.mesh.faces
    arrays = {"faces": faces.flat.astype(np.uint32), "offsets": faces.offsets.astype(np.uint32)}
    return Frame({"coordinates": cage.coordinates, "kinds": list(KINDS)}, arrays)


@command("cage.build")
def build(session: Session, request: Request) -> None:
    """Build a cage around the shape as it is now, and make it a layer."""
    scene, plan = session.required, _plan(request)
    kind = _kind(request)
    shape = scene.mesh.with_points(session.shown.binding.result)

    def work(job: Job) -> Construction:
        return plan.build(shape, lambda part: _tell(session, job, part))

    def done(found: Construction) -> None:
        _still(session, scene)
        stack, layer = with_layer(scene.stack, "Cage", Cage(found.cage, coordinates=kind))
        session.commit(scene.replace(stack=stack), "add", layer)
        left_out = [f"{each.number}: {each.reason}" for each in found.left_out]
        session.broadcast(Frame({"event": "cage-planes", "layer": layer, "left_out": left_out}))

    session.jobs.run("Cage", work, done)


@command("cage.sketch", reads=True)
def show(session: Session, request: Request) -> Frame:
    """The rings around the planes so far."""
    shape = session.required.mesh.with_points(session.shown.binding.result)
    found = sketch(_plan(request).builder(shape))
    arrays = {"points": found.points.astype(np.float32).reshape(-1), "links": found.links.reshape(-1)}
    return Frame({"linked": found.linked, "message": found.message}, arrays)


@command("cage.cut", reads=True)
def cut(session: Session, request: Request) -> Frame:
    """The plane of a line that was drawn across a limb."""
    shape = session.required.mesh.with_points(session.shown.binding.result)
    found = plane_across(shape, request.numbers("inside", 3), request.numbers("first", 6), request.numbers("second", 6))
    return Frame({"cut": [*found.origin.tolist(), *found.normal.tolist()]})


@command("cage.check")
def check(session: Session, request: Request) -> None:
    """Verify a cage at rest, in the background; all pages are told."""
    name = request.text("layer")
    cage = _cage(session.required.stack, name)
    given = session.required.mesh.with_points(session.shown.binding.below(name))

    def done(report: dict[str, Any]) -> None:
        session.broadcast(Frame({"event": "cage-report", "layer": name, "report": report}))

    session.jobs.run(name, lambda _: told(check_cage(cage.mesh, given)), done)


@command("cage.coordinates")
def exchange(session: Session, request: Request) -> None:
    """Other coordinates, on the same edit."""
    scene, name = session.required, request.text("layer")
    cage, binding = _cage(scene.stack, name), session.shown.binding
    stack = scene.stack.replace(name, deformer=replace(cage, coordinates=_kind(request)))

    def done(_: Any) -> None:
        _still(session, scene)
        session.commit(scene.replace(stack=stack), "coordinates", name)

    session.jobs.run(name, lambda _: binding.updated(stack), done)  # what it computes is kept for the commit


@command("cage.compare")
def compare(session: Session, request: Request) -> None:
    """What other coordinates make of the same edit: how far from the present shape, and how much volume."""
    scene, name = session.required, request.text("layer")
    cage, binding = _cage(scene.stack, name), session.shown.binding
    kinds = [_known(str(kind)) for kind in request.several("kinds")]
    now = np.array(binding.result)

    def work(job: Job) -> dict[str, Points]:
        found = {}
        for number, kind in enumerate(kinds):
            _tell(session, job, number / len(kinds))
            found[kind] = _other(scene.stack, binding, name, replace(cage, coordinates=kind))
        return found

    def done(found: dict[str, Points]) -> None:
        if session.scene is not scene:
            return
        session.beside[_KEPT] = (scene, found)
        rows = [_row(scene.mesh, kind, points, now) for kind, points in found.items()]
        session.broadcast(Frame({"event": "cage-comparison", "layer": name, "rows": rows}))

    session.jobs.run(name, work, done)


@command("cage.other")
def other(session: Session, request: Request) -> Frame:
    """The shape under other coordinates that were compared, and its distance from the present one."""
    kept = session.beside.get(_KEPT)
    kind = request.text("coordinates")
    if kept is None or kept[0] is not session.scene or kind not in kept[1]:
        raise InvalidParameter("the shape has changed since: compare again")
    points, now = kept[1][kind], session.shown.binding.result
    away = np.linalg.norm(points - now, axis=1)
    arrays = {
        "positions": points.astype(np.float32),
        "normals": session.shown.drawn.normals(points),
        "values": away.astype(np.float32),
        "table": np.rint(255 * color_table(SEQUENTIAL)).astype(np.uint8),
    }
    return Frame({"high": float(away.max(initial=0.0))}, arrays)


@command("cage.beside")
def beside(session: Session, request: Request) -> None:
    """Compute other coordinates, to be shown beside the present ones; pages are told when they are there."""
    scene, name, kind = session.required, request.text("layer"), _kind(request)
    cage, binding = _cage(scene.stack, name), session.shown.binding
    stack = scene.stack.replace(name, deformer=replace(cage, coordinates=kind))

    def done(found: StackBinding) -> None:
        if session.scene is scene:
            session.beside.setdefault(_BESIDE, {})[name, kind] = found
            session.broadcast(Frame({"event": "cage-beside", "layer": name, "coordinates": kind}))

    session.jobs.run(name, lambda _: binding.updated(stack), done)


@command("cage.beside_at")
def beside_at(session: Session, request: Request) -> Frame:
    """The shape under other coordinates, in the pose of the present drag; nothing while they are computed."""
    name, kind, kept = request.text("layer"), _kind(request), session.beside.get(_BESIDE, {})
    stack = session.required.stack if session.dragging is None else session.dragging.stack
    cage, found = _cage(stack, name), kept.get((name, kind))
    if found is None or not _alike(known := found.stack[name].deformer, cage):
        return Frame()
    kept[name, kind] = found = found.updated(stack.replace(name, deformer=known.moved(cage.controls)))
    arrays = {"positions": found.result.astype(np.float32), "normals": session.shown.drawn.normals(found.result)}
    return Frame({}, arrays)


def _alike(one: Cage, other: Cage) -> bool:
    """Whether two cages differ in their coordinates and their pose at most."""
    names = ("outside", "levels", "precision", "threshold")
    return one.mesh is other.mesh and all(getattr(one, name) == getattr(other, name) for name in names)


def _plan(request: Request) -> Plan:
    method, symmetry = request.text("method", "offset"), request.text("symmetry", "")
    if method not in METHODS or symmetry not in ("", "x", "y", "z"):
        raise InvalidParameter(f"a cage is not built by {method!r} with the symmetry {symmetry!r}")
    vertices = request.integer("vertices", 150)
    if not 8 <= vertices <= MOST_VERTICES:
        raise InvalidParameter(f"a cage of {vertices} vertices was asked for; 8 to {MOST_VERTICES:,} can be built")
    planes = np.asarray(request.array("cuts"), np.float64) if "cuts" in request.arrays else np.empty(0)
    if planes.size % 6 or not np.isfinite(planes).all():
        raise InvalidParameter("the array 'cuts' holds an origin and a normal for each plane: six numbers")
    return Plan(
        method, vertices, request.number("margin", 0.02), symmetry or None, planes.reshape(-1, 6),  # type: ignore[arg-type]
        request.integer("sides", 6),
    )  # fmt: skip


def _kind(request: Request) -> Any:
    return _known(request.text("coordinates", "mean_value"))


def _known(kind: str) -> Any:
    if kind not in KINDS:
        raise InvalidParameter(f"there are no coordinates {kind!r}; there are: {', '.join(KINDS)}")
    return kind


def _cage(stack: Stack, layer: str) -> Cage:
    deformer = stack[layer].deformer
    if not isinstance(deformer, Cage):
        raise InvalidParameter(f"layer {layer!r} has no cage")
    return deformer


def _other(stack: Stack, binding: Any, name: str, cage: Cage) -> Points:
    return np.array(binding.updated(stack.replace(name, deformer=cage)).result)


def _row(mesh: PolygonMesh, kind: str, points: Points, now: Points) -> dict[str, Any]:
    rest = volume(mesh) if mesh.edge_use == (0, 0) else 0.0
    return {
        "coordinates": kind,
        "away": float(np.linalg.norm(points - now, axis=1).max(initial=0.0) / (mesh.diagonal or 1.0)),
        "volume": float(volume(mesh.with_points(points)) / rest) if rest else None,
    }


def _tell(session: Session, job: Job, part: float) -> None:
    """Say how far a job is; give up where it was stopped."""
    if job.stopped.is_set():
        raise NotConverged("stopped")
    session.submit(session.jobs.tell, job, part)


def _still(session: Session, scene: Scene) -> None:
    """The scene that a result is for is still shown, and nobody drags in it any more."""
    if session.scene is not scene:
        raise InvalidParameter("the scene has changed while the cage was computed: try again")
    session.drop_drag()
