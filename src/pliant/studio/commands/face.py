"""Faces: a photograph becomes a face, whose caricature is a layer; landmarks, folds, handles."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from pliant.errors import InvalidParameter
from pliant.face.handles import FaceHandles
from pliant.scene.layer import Layer
from pliant.studio.commands.opening import enter
from pliant.studio.jobs import Job
from pliant.studio.modes.faces import example_photograph, face_layer, face_scene, looked_at, missing, photograph_of
from pliant.studio.modes.layering import free_name
from pliant.studio.request import Request, command
from pliant.studio.seen.stage import Stage
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session

HANDLES = "Handles"


@command("face.ready", reads=True)
def ready(session: Session, request: Request) -> Frame:
    """Whether photographs can be looked at, else what is missing; whether there is an example."""
    return Frame({"missing": missing(), "example": example_photograph() is not None})


@command("face.open")
def open_photograph(session: Session, request: Request) -> None:
    """The face in an uploaded photograph, or in the example; in the background."""
    _look(session, _photograph(session, request), request.integer("number", 0))


@command("face.get")
def get(session: Session, request: Request) -> Frame:
    """Where the landmarks are on the face as it is, which face of the photograph it is, and of how many."""
    scene = session.required
    landmarks = face_layer(scene.stack, request.text("layer")).landmarks
    stack = scene.stack if session.dragging is None else session.dragging.stack
    seen = np.asarray(stack(landmarks)) if all(layer.in_space for layer in stack.active) else landmarks
    _, number, count = session.beside.get("photograph", (None, 0, 1))
    return Frame({"number": number, "count": count}, {"landmarks": seen.astype(np.float32)})


@command("face.other")
def other(session: Session, request: Request) -> None:
    """Another face of the same photograph."""
    if "photograph" not in session.beside:
        raise InvalidParameter("the photograph is not at hand any more: open it again")
    path, _, _ = session.beside["photograph"]
    _look(session, path, request.integer("number"))


@command("face.folds", reads=True)
def folds(session: Session, request: Request) -> Frame:
    """Whether the caricature folds the face, and the amount at which it does not."""
    scene = session.required
    deformer = face_layer(scene.stack, request.text("layer"))
    found = looked_at(deformer, scene.mesh)
    return Frame({"least": found.least, "folds": found.part < 1, "amount": deformer.amount * found.part})


@command("face.reduce")
def reduce(session: Session, request: Request) -> None:
    """As much of the caricature as does not fold."""
    scene, name = session.required, request.text("layer")
    deformer = face_layer(scene.stack, name)
    amount = deformer.amount * looked_at(deformer, scene.mesh).part
    stack = scene.stack.replace(name, deformer=replace(deformer, amount=amount))
    session.commit(scene.replace(stack=stack), "limit", name)


@command("face.handles")
def handles(session: Session, request: Request) -> Frame:
    """Named handles of the features, under the caricature: for the mode of control points."""
    scene, name = session.required, request.text("layer")
    landmarks = face_layer(scene.stack, name).landmarks
    known = [layer.name for layer in scene.stack if isinstance(layer.deformer, FaceHandles)]
    if known:
        return Frame({"layer": known[0]})
    found = free_name(HANDLES, scene.stack.names)
    stack = scene.stack.insert(scene.stack.index(name), Layer(found, FaceHandles(landmarks)))
    session.commit(scene.replace(stack=stack), "add", found)
    return Frame({"layer": found})


def _look(session: Session, path: Path, number: int) -> None:
    def work(_: Job) -> tuple[Stage, int]:
        scene, count = face_scene(path, number)
        return Stage(scene), count

    def done(found: tuple[Stage, int]) -> None:
        stage, count = found
        enter(session, stage, path.stem, "face")
        session.beside["photograph"] = (path, number, count)

    session.jobs.run(path.name, work, done)


def _photograph(session: Session, request: Request) -> Path:
    if "upload" not in request.values:
        path = example_photograph()
        if path is None:
            raise InvalidParameter("the example is a picture of scikit-image: pip install 'pliant[cages]'")
        return path
    found = session.uploads.get(request.text("upload"))
    if not found.complete:
        raise InvalidParameter("the photograph has not come whole: send it again")
    path = photograph_of([found.path(at) for at in range(len(found.names))])
    if path is None:
        raise InvalidParameter(f"{', '.join(found.names)}: no photograph; give a JPEG, PNG, WebP or TIFF file")
    return path
