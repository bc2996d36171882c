"""Surface editing: regions picked on the screen and along the surface, edits by three methods, the skeleton."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.numerics.meshes.geodesics import GeodesicDistances
from pliant.studio.dragging import begin, cancel, commit, ongoing
from pliant.studio.modes.method_switch import edit_of, exchange, method_of
from pliant.studio.modes.skeletons import show_skeleton, skeleton_frame
from pliant.studio.modes.surface_drag import SurfaceDrag
from pliant.studio.request import Request, command
from pliant.studio.seen.parts import vertices_of
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session
from pliant.surface import regions
from pliant.surface.screen import SeenMesh

_MANY = 40_000  # triangles: with fewer, distances take no time
_MOST_CONTOURS, _MOST_EIGENVECTORS = 300, 60


@command("surface.within", reads=True)
def within(session: Session, request: Request) -> Frame:
    """The vertices inside an outline on the screen."""
    return _indices(_seen(session, request).inside(_places(request, "outline"), visible=request.truth("visible")))


@command("surface.brush", reads=True)
def brush(session: Session, request: Request) -> Frame:
    """The vertices under a stroke."""
    seen, size = _seen(session, request), (request.number("wide"), request.number("high"))
    return _indices(seen.under(_places(request, "path"), size, visible=request.truth("visible")))


@command("surface.distances", reads=True)
def distances(session: Session, request: Request) -> Frame:
    """How far each vertex is, along the shape as it is, from some: the page draws the line."""
    stage = session.shown
    start = request.indices("index", len(stage.scene.mesh.points))
    if not len(start):
        raise InvalidParameter("there is no vertex to measure from: click on the surface")
    found = _along(session)(start)
    return Frame({}, {"distances": np.where(np.isfinite(found), found, 1e30).astype(np.float32)})


@command("surface.measure")
def measure(session: Session, request: Request) -> None:
    """Somebody will ask for distances: on a large shape, what they need is computed in the background."""
    if len(session.shown.drawn.triangles) > _MANY:
        along = _along(session)
        if not along.ready:
            session.jobs.run("Distances", lambda _: along.prepare(), lambda _: None)


@command("surface.grow", reads=True)
def grow(session: Session, request: Request) -> Frame:
    """A region with so many rings of neighbours more; fewer than none shrinks it."""
    mesh = session.required.mesh
    return _indices(regions.grow(mesh, request.indices("index", len(mesh.points)), request.integer("rings")))


@command("surface.part", reads=True)
def part(session: Session, request: Request) -> Frame:
    """The vertices of a part that has a name."""
    return _indices(vertices_of(session.required, request.text("part")))


@command("surface.keep")
def keep(session: Session, request: Request) -> None:
    """Give a region a name; it is saved with the scene."""
    scene, name = session.required, request.text("name").strip()
    chosen = request.indices("index", len(scene.mesh.points))
    if not name or not len(chosen):
        raise InvalidParameter("a selection needs a name and at least one vertex: select something first")
    session.drop_drag()
    session.commit(scene.replace(selections={**scene.selections, name: np.unique(chosen)}), "select", name)


@command("surface.forget")
def forget(session: Session, request: Request) -> None:
    """Without a named region."""
    scene, name = session.required, request.text("name")
    if name not in scene.selections:
        raise InvalidParameter(f"there is no selection {name!r}")
    left = {known: chosen for known, chosen in scene.selections.items() if known != name}
    session.drop_drag()
    session.commit(scene.replace(selections=left), "deselect", name)


@command("surface.region", reads=True)
def region(session: Session, request: Request) -> Frame:
    """Region, handle and method of a layer that edits the surface."""
    deformer = edit_of(session.required.stack, request.text("layer"))
    everywhere = np.arange(len(session.required.mesh.points))
    arrays = {"region": everywhere[np.asarray(deformer.roi)], "handle": everywhere[np.asarray(deformer.handle)]}
    return Frame({"method": method_of(deformer)}, {name: _small(array) for name, array in arrays.items()})


@command("surface.restructure")
def restructure(session: Session, request: Request) -> None:
    """Another region and handle for a layer: vertices that join the handle stay where the edit has put them."""
    stack, name = session.required.stack, request.text("layer")
    count = len(session.required.mesh.points)
    deformer = edit_of(stack, name)
    roi, handle = request.indices("region", count), request.indices("handle", count)
    made = replace(deformer, roi=roi, handle=handle, goal=None)
    if deformer.goal is not None:
        made = made.moved(session.shown.binding.bound(name).deform(deformer.goal)[handle])
    session.drop_drag()
    session.commit(session.required.replace(stack=stack.replace(name, deformer=made)), "region", name)


@command("surface.method")
def method(session: Session, request: Request) -> Frame:
    """The same edit by another method: at once, or when a job has bound it."""
    coming = exchange(session, request.text("layer"), request.text("method"))
    return Frame({} if coming is None else {"job": coming.name})


@command("surface.begin")
def take_hold(session: Session, request: Request) -> Frame:
    """Take hold of a handle: of a layer's, or of one that a new layer is made of."""
    name, wanted = request.text("layer", ""), request.text("method")
    count = len(session.required.mesh.points)
    structure = None
    if not name:
        structure = request.indices("region", count), request.indices("handle", count)
    drag = SurfaceDrag(session, request.client, name, wanted, structure)
    begin(drag, session)
    return Frame({"layer": drag.layer, **_by(drag)})


@command("surface.move")
def move(session: Session, request: Request) -> Frame:
    """Put the handle somewhere else, by this method or by another; where it is already, go on converging."""
    drag = _surface_drag(session, request)
    frame = drag.preview(request)
    return Frame({**frame.head, **_by(drag)}, frame.arrays)


@command("surface.commit")
def let_go(session: Session, request: Request) -> None:
    """Let go of the handle, where it is: what is left of a long iteration goes on in the background."""
    drag = _surface_drag(session, request)
    near = drag.suppose()
    drag.give_up()
    commit(session, request)
    if near:
        binding = session.shown.binding
        session.jobs.run(drag.layer, lambda _: binding.settled(), lambda _: session.show_again())


@command("surface.cancel")
def give_up(session: Session, request: Request) -> None:
    """Undo what the drag did, and wait for no other method."""
    _surface_drag(session, request).give_up()
    cancel(session, request)


@command("surface.skeleton")
def skeleton(session: Session, request: Request) -> Frame:
    """The contour skeleton: at once where it is known, else in the background."""
    contours, eigenvectors = request.integer("contours", 30), request.integer("eigenvectors", 10)
    if not (1 <= contours <= _MOST_CONTOURS and 2 <= eigenvectors <= _MOST_EIGENVECTORS):
        raise InvalidParameter(
            f"a skeleton has 1 to {_MOST_CONTOURS} contours and 2 to {_MOST_EIGENVECTORS} eigenvectors; "
            f"asked for {contours} and {eigenvectors}"
        )
    if show_skeleton(session, contours, eigenvectors):
        frame = skeleton_frame(session)
        return Frame({**frame.head, "known": True}, frame.arrays)
    return Frame({"known": False})


def _surface_drag(session: Session, request: Request) -> SurfaceDrag:
    drag = ongoing(session, request)
    if not isinstance(drag, SurfaceDrag):
        raise InvalidParameter("what is dragged on this page is no handle of the surface")
    return drag


def _by(drag: SurfaceDrag) -> dict[str, str]:
    """The method of a drag, and the job that binds another, or which one has been given up."""
    coming = drag.coming
    if coming is None:
        return {"method": drag.method}
    return {"method": drag.method} | ({"given_up": coming.method} if coming.given_up else {"job": coming.name})


def _seen(session: Session, request: Request) -> SeenMesh:
    """The shape through the page's camera, kept for the strokes that follow from the same place."""
    camera = np.asarray(request.array("camera"), np.float64)
    if camera.size != 16:
        raise InvalidParameter(f"a camera has 16 numbers; given: {camera.size}")
    stage = session.shown
    key = (stage.id, session.revision, camera.tobytes())
    known = session.beside.get("seen")
    if known is None or known[0] != key:
        matrix = camera.reshape(4, 4).T  # columns travel one after another
        known = key, SeenMesh(stage.binding.result, stage.drawn.triangles, matrix)
        session.beside["seen"] = known
    found: SeenMesh = known[1]
    return found


def _along(session: Session) -> GeodesicDistances:
    """Distances along the shape as it is, kept until it is another one."""
    stage = session.shown
    key = (stage.id, session.revision)
    known = session.beside.get("along")
    if known is None or known[0] != key:
        known = key, GeodesicDistances(stage.binding.result, stage.drawn.triangles)
        session.beside["along"] = known
    found: GeodesicDistances = known[1]
    return found


def _places(request: Request, name: str) -> NDArray[np.float64]:
    array = request.array(name)
    if array.size % 2:
        raise InvalidParameter(f"{name} has {array.size} numbers; two a place on the screen are needed")
    return np.asarray(array, np.float64).reshape(-1, 2)


def _indices(found: NDArray[np.int64]) -> Frame:
    return Frame({}, {"index": _small(found)})


def _small(indices: NDArray[np.int64]) -> NDArray[np.uint32]:
    return indices.astype(np.uint32)
