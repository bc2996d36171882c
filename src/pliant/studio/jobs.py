"""Long work beside the session: it goes on while people drag, is told of, and can be stopped.

Each job works on a scene of its own, which cannot change, and hands its result to the session's thread; a result for
a scene that is no longer shown is dropped.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from threading import Event
from typing import TYPE_CHECKING, Any

from pliant.errors import PliantError
from pliant.field.certificate import Certificate
from pliant.field.certifying import certify
from pliant.scene.scene import Scene
from pliant.studio.request import Client
from pliant.studio.seen.spaces import space_map
from pliant.studio.serving.frames import Frame

if TYPE_CHECKING:
    from pliant.studio.session import Session

_BUDGET = 4000  # boxes that a proof may halve: a second or two


class Outdated(PliantError):
    """The scene has changed while something was computed of it."""


@dataclass(frozen=True)
class Job:
    """Work under way.

    Parameters
    ----------
    name
        What pages call it.
    title
        What it is.
    stopped
        Set when it shall stop.
    """

    name: str
    title: str
    stopped: Event = field(default_factory=Event)


class Jobs:
    """The work of a session."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._pool = ThreadPoolExecutor(1, "pliant-job")
        self._numbers = itertools.count(1)
        self._running: dict[str, Job] = {}
        self._fold: dict[str, Any] = {"status": "none"}
        self._looking = 0

    def run(self, title: str, work: Callable[[Job], Any], done: Callable[[Any], None]) -> Job:
        """Begin something long; ``done`` gets its result on the session's thread."""
        job = Job(f"job-{next(self._numbers)}", title)
        self._running[job.name] = job
        head = {"event": "progress", "job": job.name, "title": title, "part": None, "cancellable": True}
        self._session.broadcast(Frame(head))
        self._pool.submit(self._work, job, work, done)
        return job

    def tell(self, job: Job, part: float) -> None:
        """Say how far a job is, from 0 to 1; on the session's thread."""
        if job.name in self._running:
            head = {"event": "progress", "job": job.name, "title": job.title, "part": part, "cancellable": True}
            self._session.broadcast(Frame(head))

    def stop(self, name: str) -> None:
        """Ask a job to stop: its result will not count."""
        job = self._running.pop(name, None)
        if job is not None:
            job.stopped.set()
            self._session.broadcast(Frame({"event": "progress-end", "job": name}))

    def end(self) -> None:
        """Stop all."""
        for job in self._running.values():
            job.stopped.set()
        self._pool.shutdown(wait=True, cancel_futures=True)

    def look_for_folds(self) -> None:
        """Prove in the background that the deformation does not fold, or find where it does."""
        session = self._session
        scene = session.required
        self._looking += 1
        if not scene.stack.active:
            self._say({"status": "none"})
            return
        self._say({"status": "checking"})
        self._pool.submit(self._look, scene, self._looking)

    def tell_fold(self, clients: list[Client]) -> None:
        """Tell pages what is known of folds."""
        data = Frame({"event": "fold", "fold": self._fold}).encode()
        for client in clients:
            client.send(data)

    def _look(self, scene: Scene, ticket: int) -> None:
        if ticket != self._looking:
            return  # somebody has dragged on
        try:
            told = partial(self._looked, ticket)
            proof = certify(space_map(scene.stack), budget=_BUDGET, bounds=scene.mesh.bounds, progress=told)
            found = _told(proof)
        except PliantError:
            found = {"status": "none"}
        self._hand_over(self._take, found, ticket)

    def _looked(self, ticket: int, part: float) -> None:
        """A proof is that far; one that nobody waits for any more ends."""
        if ticket != self._looking:
            raise Outdated("somebody has dragged on")
        self._hand_over(self._take, {"status": "checking", "part": part}, ticket)

    def _take(self, found: dict[str, Any], ticket: int) -> None:
        if ticket == self._looking:
            self._say(found)

    def _say(self, fold: dict[str, Any]) -> None:
        self._fold = fold
        self.tell_fold(self._session.clients)

    def _work(self, job: Job, work: Callable[[Job], Any], done: Callable[[Any], None]) -> None:
        try:
            result = None if job.stopped.is_set() else work(job)
        except PliantError as error:
            self._hand_over(self._fail, job, str(error))
            return
        self._hand_over(self._finish, job, done, result)

    def _finish(self, job: Job, done: Callable[[Any], None], result: Any) -> None:
        if not job.stopped.is_set():
            try:
                done(result)
            except PliantError as error:
                self._fail(job, str(error))
        self.stop(job.name)

    def _fail(self, job: Job, message: str) -> None:
        if not job.stopped.is_set():
            self._session.broadcast(Frame({"event": "failure", "message": message}))
        self.stop(job.name)

    def _hand_over(self, function: Callable[..., None], *arguments: Any) -> None:
        try:
            self._session.submit(function, *arguments)
        except RuntimeError:  # the session has ended
            return


def _told(proof: Certificate) -> dict[str, Any]:
    status = proof.status
    return {"status": status, "point": proof.point, "least": proof.least, "lower": max(proof.lower, -1e300)}
