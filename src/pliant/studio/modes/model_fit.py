"""Fitting a shape model to a target, watched: each round is shown, and may be the last."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter, PliantError
from pliant.mesh import PolygonMesh
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.shape.basis import Floats
from pliant.shape.registration import Fit, Pose, Round
from pliant.studio.jobs import Job
from pliant.studio.modes.shape_models import fitted_stack, model_layer, prior_coefficients
from pliant.studio.seen.drawn import DrawnMesh
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session

_BESIDE = "target"


class Stopped(PliantError):
    """Somebody has stopped the fit."""


@dataclass(frozen=True, eq=False)
class Fitting:
    """A fit under way.

    Parameters
    ----------
    session
        Where it happens.
    scene
        What it began with.
    layer
        The layer of the model.
    target
        What the model shall lie on.
    pose
        How the model may move: None, ``"rigid"`` or ``"similarity"``.
    rounds
        At most so many.
    """

    session: Session
    scene: Scene
    layer: str
    target: PolygonMesh
    pose: Pose | None
    rounds: int

    def work(self, job: Job) -> Stack:
        """Fit; gives the stack of the fitted shape."""
        shape = model_layer(self.scene.stack, self.layer)

        def watch(each: Round) -> None:
            self._submit(self._show, job, each.number / each.most, self._stack(each.coefficients, each.pose))
            if job.stopped.is_set():
                raise Stopped

        try:
            found: Fit = shape.posterior().fit(self.target, iterations=self.rounds, pose=self.pose, watch=watch)
        except PliantError:
            self._submit(self._restore)
            raise
        return self._stack(found.coefficients, found.pose)

    def _stack(self, coefficients: Floats, pose: Floats) -> Stack:
        shape = model_layer(self.scene.stack, self.layer)
        return fitted_stack(self.scene.stack, self.layer, prior_coefficients(shape, coefficients), pose)

    def done(self, stack: Stack) -> None:
        """Keep the fitted shape, where the scene is still the one that it began with."""
        if self.session.scene is self.scene:
            self.session.commit(self.scene.replace(stack=stack), "fit", self.layer)

    def _show(self, job: Job, part: float, stack: Stack) -> None:
        """A round, without history."""
        session = self.session
        if session.scene is not self.scene or session.dragging is not None or job.stopped.is_set():
            return
        session.jobs.tell(job, part)
        stage = session.shown
        points = stage.binding.updated(stack).result
        stage.told[:] = np.nan  # to be told again, exactly, when the fit ends
        arrays: dict[str, NDArray[Any]] = {
            "positions": points.astype(np.float32),
            "normals": stage.drawn.normals(points),
        }
        session.broadcast(Frame({"event": "points", "all": True}, arrays))

    def _restore(self) -> None:
        moved = self.session.shown.moved_frame() if self.session.stage is not None else None
        if moved is not None:
            self.session.broadcast(moved)

    def _submit(self, function: object, *arguments: object) -> None:
        self.session.submit(function, *arguments)  # type: ignore[arg-type]


def keep_target(session: Session, mesh: PolygonMesh, name: str) -> Frame:
    """Keep a mesh beside the scene, to be fitted to; gives how it is drawn."""
    session.beside[_BESIDE] = (mesh, name)
    return target_frame(session)


def forget_target(session: Session) -> None:
    """Without a target."""
    session.beside.pop(_BESIDE, None)


def target_of(session: Session) -> PolygonMesh:
    """The target.

    Raises
    ------
    InvalidParameter
        There is none.
    """
    if _BESIDE not in session.beside:
        raise InvalidParameter("there is no target to fit to: load one first")
    mesh: PolygonMesh = session.beside[_BESIDE][0]
    return mesh


def target_frame(session: Session) -> Frame:
    """How the target is drawn; empty where there is none."""
    if _BESIDE not in session.beside:
        return Frame({"name": ""})
    mesh, name = session.beside[_BESIDE]
    drawn = DrawnMesh(mesh)
    arrays = {
        "positions": mesh.points.astype(np.float32),
        "normals": drawn.normals(mesh.points),
        "triangles": drawn.triangles.astype(np.uint32),
    }
    return Frame({"name": name, "points": len(mesh.points)}, arrays)
