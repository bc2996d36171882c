"""Sites: placed by a click on the surface, scattered, mirrored, deleted."""

from __future__ import annotations

import numpy as np

from pliant.errors import InvalidParameter
from pliant.mesh import Points, PolygonMesh
from pliant.shape.surface_samples import surface_samples
from pliant.space.dirichlet_ffd import DirichletFFD
from pliant.studio.modes.layering import with_layer
from pliant.studio.modes.siting import apart, mirrored, with_sites, without_sites
from pliant.studio.request import Request, command
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session

MOST = 2000
_NAME = "Sites"


@command("sites.place")
def place(session: Session, request: Request) -> Frame:
    """A site where the surface was clicked; with ``mirror`` a second one on the other side.

    A layer needs two sites: the first of a new one waits for the second.
    """
    name = request.text("layer", "")
    layer = name if name and isinstance(session.required.stack[name].deformer, DirichletFFD) else ""
    at = _clicked(session, request, layer)
    axis = request.integer("mirror", -1)
    if axis in (0, 1, 2):
        at = np.concatenate([at, mirrored(at, _given(session, layer), axis)])
        if np.linalg.norm(at[1] - at[0]) < apart(session.required.mesh.diagonal):
            at = at[:1]  # it stands in the middle
    if layer:
        before = _sites(session, layer)
        after = with_sites(before, at, apart(session.required.mesh.diagonal))
        return _commit(session, layer, after, len(before.sites))
    waiting: Points = np.concatenate([session.beside.get(_NAME, np.empty((0, 3))), at])
    if len(waiting) < 2:
        session.beside[_NAME] = waiting
        return Frame({"layer": "", "site": 0}, {"waiting": waiting.reshape(-1)})
    session.beside.pop(_NAME, None)
    return _begun(session, waiting)


@command("sites.scatter")
def scatter(session: Session, request: Request) -> Frame:
    """A new layer of sites that are spread over the surface, each as far as can be from the others."""
    count = request.integer("count")
    if not 2 <= count <= MOST:
        raise InvalidParameter(f"{count} sites were asked for; 2 to {MOST} can be scattered")
    return _begun(session, surface_samples(_given(session, ""), count, "farthest"))


@command("sites.mirror")
def mirror(session: Session, request: Request) -> Frame:
    """Sites on the other side for those that have none there."""
    name, axis = request.text("layer"), request.integer("axis")
    if axis not in (0, 1, 2):
        raise InvalidParameter(f"axis is {axis}; it must be 0, 1 or 2")
    deformer = _sites(session, name)
    images = mirrored(deformer.sites, _given(session, name), axis)
    room = 0.02 * session.required.mesh.diagonal
    new = [image for image in images if np.linalg.norm(deformer.sites - image, axis=1).min() > room]
    if not new:
        raise InvalidParameter("each site has one on the other side already")
    return _commit(session, name, with_sites(deformer, np.array(new), room), len(deformer.sites))


@command("sites.remove")
def remove(session: Session, request: Request) -> None:
    """Without some sites."""
    name = request.text("layer")
    deformer = _sites(session, name)
    chosen = request.indices("index", len(deformer.sites))
    locked = session.locked.get(name, set())
    if locked & set(chosen.tolist()):
        raise InvalidParameter("a locked site cannot be deleted: unlock it first")
    after = without_sites(deformer, chosen)
    session.locked[name] = {at - int((chosen < at).sum()) for at in locked}
    _commit(session, name, after, 0)


def _clicked(session: Session, request: Request, layer: str) -> Points:
    """(1, 3) where a clicked place of the surface rests: below the layer, or where it is now for a new one."""
    mesh, shown = session.required.mesh, session.shown.binding
    corners = request.numbers("triangle", 3).astype(np.int64).tolist()
    if not all(0 <= vertex < len(mesh.points) for vertex in corners):
        raise InvalidParameter(f"the triangle {corners} is none of this mesh")
    weights = request.numbers("weights", 3)
    if abs(weights.sum() - 1) > 1e-3:
        raise InvalidParameter(f"the weights {weights.tolist()} of a triangle's corners must sum to one")
    points = shown.below(layer) if layer else shown.result
    return np.asarray(weights[None] @ points[corners])


def _given(session: Session, layer: str) -> PolygonMesh:
    """The shape that a layer is given; a new one, as the shape is now."""
    shown = session.shown.binding
    return session.required.mesh.with_points(shown.below(layer) if layer else shown.result)


def _sites(session: Session, name: str) -> DirichletFFD:
    deformer = session.required.stack[name].deformer
    if not isinstance(deformer, DirichletFFD):
        raise InvalidParameter(f"layer {name!r} has no sites")
    return deformer


def _begun(session: Session, places: Points) -> Frame:
    scene = session.required
    stack, layer = with_layer(scene.stack, _NAME, DirichletFFD(places))
    session.commit(scene.replace(stack=stack), "add", layer)
    return Frame({"layer": layer, "site": len(places) - 1})


def _commit(session: Session, name: str, deformer: DirichletFFD, first: int) -> Frame:
    session.drop_drag()
    stack = session.required.stack.replace(name, deformer=deformer)
    session.commit(session.required.replace(stack=stack), "sites", name)
    return Frame({"layer": name, "site": first})
