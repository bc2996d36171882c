"""Shape models: built, moved by sliders and landmarks, sampled, fitted to a target; random fields of a kernel."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import Any, Literal, cast, get_args

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter, NotDifferentiable
from pliant.io import meshes
from pliant.rendering.palette import SEQUENTIAL, color_table
from pliant.shape.conditioned_model import ConditionedModel
from pliant.shape.gaussian_process import GaussianProcess
from pliant.shape.kernels import GaussianKernel
from pliant.shape.registration import Pose
from pliant.shape.surface_samples import farthest
from pliant.studio.commands.opening import main_file
from pliant.studio.dragging import begin, cancel, commit, ongoing
from pliant.studio.modes.layering import with_layer
from pliant.studio.modes.model_drag import ModelDrag
from pliant.studio.modes.model_fit import Fitting, forget_target, keep_target, target_frame, target_of
from pliant.studio.modes.shape_models import NAME, built, layers_above, model_layer
from pliant.studio.request import Request, command
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session

_MOST_ARROWS = 600
_MOST_ROUNDS = 500
_METHODS = ("cholesky", "nystrom")


@command("model.build")
def build(session: Session, request: Request) -> None:
    """A model around the shape at rest, from a kernel; in the background."""
    scene, kernel, rank = session.required, request.text("kernel"), request.integer("rank")
    method = request.text("method", "cholesky")
    if method not in _METHODS:
        raise InvalidParameter(f"a model is built by {' or '.join(_METHODS)}, not by {method!r}")

    def done(shape: ConditionedModel) -> None:
        if session.scene is scene:
            stack, layer = with_layer(scene.stack, NAME, shape)
            session.commit(scene.replace(stack=stack), "add", layer)

    way = cast("Literal['cholesky', 'nystrom']", method)
    session.jobs.run(NAME, lambda _: built(scene.mesh, kernel, rank, way), done)


@command("model.get", reads=True)
def get(session: Session, request: Request) -> Frame:
    """What a page needs of a model to move it."""
    stack, name = session.required.stack, request.text("layer")
    shape = model_layer(stack, name)
    model, positions = shape.model, np.asarray(shape.positions)
    with suppress(NotDifferentiable):  # where the surface is edited, they are shown where the model has them
        positions = np.asarray(layers_above(stack, name)(positions))
    head = {"rank": model.rank, "count": model.count, "noise": shape.noise, "scalar": model.basis.scalar}
    arrays = {
        "coefficients": np.asarray(shape.coefficients),
        "vertices": np.asarray(shape.vertices, np.uint32),
        "positions": positions.reshape(-1),
        "variances": model.variances / (model.variances.sum() or 1.0),
    }
    return Frame(head, arrays)


@command("model.begin")
def drag(session: Session, request: Request) -> None:
    """Take hold of sliders, or of landmarks."""
    begin(ModelDrag(session, request.client, request.text("layer"), request.text("label", "landmark")), session)


@command("model.move")
def move(session: Session, request: Request) -> Frame:
    """Move them."""
    return ongoing(session, request).preview(request)


command("model.commit")(commit)
command("model.cancel")(cancel)


@command("model.coefficients")
def coefficients(session: Session, request: Request) -> None:
    """Other coefficients."""
    shape = model_layer(session.required.stack, request.text("layer"))
    _commit(session, request, replace(shape, coefficients=request.array("coefficients")), "coefficients")


@command("model.sample")
def sample(session: Session, request: Request) -> None:
    """Random coefficients; landmarks stay where they are seen."""
    shape = model_layer(session.required.stack, request.text("layer"))
    random = np.random.default_rng(abs(request.integer("seed")))
    _commit(session, request, replace(shape, coefficients=random.standard_normal(shape.model.count)), "sample")


@command("model.landmark")
def landmark(session: Session, request: Request) -> Frame:
    """A vertex becomes a landmark, where it is."""
    shape = model_layer(session.required.stack, request.text("layer"))
    vertex = request.integer("vertex")
    if not 0 <= vertex < len(shape.model.mean):
        raise InvalidParameter(f"there is no vertex {vertex}")
    known = np.flatnonzero(np.asarray(shape.vertices) == vertex)
    if len(known):
        return Frame({"landmark": int(known[0])})
    _commit(session, request, shape.with_landmark(vertex), "landmark")
    return Frame({"landmark": len(np.asarray(shape.vertices))})


@command("model.release")
def release(session: Session, request: Request) -> None:
    """Some landmarks are none any more."""
    shape = model_layer(session.required.stack, request.text("layer"))
    index = request.indices("index", len(np.asarray(shape.vertices)))
    _commit(session, request, shape.without_landmarks(index), "release")


@command("model.noise")
def noise(session: Session, request: Request) -> None:
    """How exactly landmarks are seen."""
    shape = model_layer(session.required.stack, request.text("layer"))
    _commit(session, request, replace(shape, noise=request.number("noise")), "noise")


@command("model.uncertainty", reads=True)
def uncertainty(session: Session, request: Request) -> Frame:
    """How far each vertex strays, given the landmarks; the colours end where it strays most without them."""
    shape = model_layer(session.required.stack, request.text("layer"))
    table = np.rint(255 * color_table(SEQUENTIAL)).astype(np.uint8)
    head = {"low": 0.0, "high": float(shape.model.uncertainty.max()) or 1.0}
    return Frame(head, {"values": shape.posterior().uncertainty.astype(np.float32), "table": table})


@command("model.target")
def target(session: Session, request: Request) -> Frame:
    """Load a mesh to fit to, from an upload; without one, what is loaded; with ``forget``, none."""
    if request.values.get("forget"):
        forget_target(session)
    if "upload" not in request.values:
        return target_frame(session)
    found = session.uploads.get(request.text("upload"))
    path = main_file([found.path(at) for at in range(len(found.names))])
    return keep_target(session, meshes.read(path), path.stem)


@command("model.fit")
def fit(session: Session, request: Request) -> None:
    """Fit to the target, in the background: each round is shown."""
    layer, pose, rounds = request.text("layer"), request.text("pose", ""), request.integer("rounds", 50)
    if pose and pose not in get_args(Pose):
        raise InvalidParameter(f"a fit moves the model by {' or '.join(get_args(Pose))}, not by {pose!r}")
    if not 1 <= rounds <= _MOST_ROUNDS:
        raise InvalidParameter(f"a fit has 1 to {_MOST_ROUNDS} rounds; asked for {rounds}")
    model_layer(session.required.stack, layer)
    work = Fitting(session, session.required, layer, target_of(session), cast("Pose | None", pose or None), rounds)
    session.jobs.run(layer, work.work, work.done)


@command("model.field", reads=True)
def field(session: Session, request: Request) -> Frame:
    """Arrows of a random field: displacements of points of the surface, drawn from a Gaussian process."""
    count = min(max(request.integer("count", 300), 1), _MOST_ARROWS)
    places = session.shown.binding.result[_spread(session, count)]
    kernel = GaussianKernel(sigma=request.number("sigma"), scale=request.number("scale"))
    vectors = GaussianProcess(kernel).draw(places, seed=abs(request.integer("seed", 0)))
    table = np.rint(255 * color_table(SEQUENTIAL)).astype(np.uint8)
    arrays: dict[str, NDArray[Any]] = {
        "positions": places.astype(np.float32),
        "vectors": vectors.astype(np.float32),
        "table": table,
    }
    return Frame({}, arrays)


def _spread(session: Session, count: int) -> NDArray[np.int64]:
    """(count,) vertices far from each other: found once for a shape."""
    points = session.required.mesh.points
    known = session.beside.get("arrows")
    if known is None or len(known) != min(count, len(points)):
        known = farthest(points, min(count, len(points)), np.random.default_rng(0))
        session.beside["arrows"] = known
    return np.asarray(known, np.int64)


def _commit(session: Session, request: Request, shape: ConditionedModel, key: str) -> None:
    session.drop_drag()
    name, scene = request.text("layer"), session.required
    session.commit(scene.replace(stack=scene.stack.replace(name, deformer=shape)), key, name)
