"""Jobs out, outcomes in: each exactly once, whatever becomes of the workers."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Future
from queue import SimpleQueue

from pliant.batch.crews import Crew
from pliant.batch.outcome import Job, Outcome, failed
from pliant.batch.parcel import Parcel

_DEATHS = 3  # workers that a job may cost before it is given up


def outcomes(crew: Crew, parcel: Parcel, jobs: Iterable[Job], strict: bool) -> Iterator[Outcome]:
    """Have jobs done.

    What a worker raises is an outcome already; what comes out of a future beside that says that a worker was lost. The
    job is then done again; writing is atomic, so that a half-done one leaves nothing. A job that loses its worker
    again and again fails. Where all workers are lost with one, the jobs that they had are done one at a time, to find
    which of them it was.
    """
    return _Dispatch(crew, parcel, strict).run(deque(jobs))


class _Dispatch:
    def __init__(self, crew: Crew, parcel: Parcel, strict: bool) -> None:
        self._crew, self._parcel, self._strict = crew, parcel, strict
        self._under_way: dict[Future[Outcome], Job] = {}
        self._done: SimpleQueue[Future[Outcome]] = SimpleQueue()
        self._suspects: deque[Job] = deque()
        self._deaths: Counter[int] = Counter()

    def run(self, waiting: deque[Job]) -> Iterator[Outcome]:
        try:
            while waiting or self._suspects or self._under_way:
                lost = self._send(waiting)
                if lost is None:
                    lost = yield from self._received()
                if isinstance(lost, BrokenExecutor):
                    while self._under_way:  # they are lost too, but for those that were done before
                        yield from self._received()
                    if not self._crew.renewed():
                        yield from (failed(job, lost) for job in (*self._suspects, *waiting))
                        return
        finally:
            for future in self._under_way:
                future.cancel()

    def _send(self, waiting: deque[Job]) -> BaseException | None:
        """Fill the crew's hands; suspects go alone. The error of a crew that takes no jobs."""
        while waiting or self._suspects:
            if len(self._under_way) >= (1 if self._suspects else self._crew.width):
                return None
            queue = self._suspects or waiting
            try:
                future = self._crew.submit(self._parcel, queue[0], self._strict)
            except RuntimeError as error:  # it is broken, or was shut down
                return error if isinstance(error, BrokenExecutor) else BrokenExecutor(str(error))
            self._under_way[future] = queue.popleft()
            future.add_done_callback(self._done.put)
        return None

    def _received(self) -> Generator[Outcome, None, BaseException | None]:
        """The next outcome, or the error that took a worker away."""
        future = self._done.get()
        job = self._under_way.pop(future)
        lost = CancelledError("the job was cancelled") if future.cancelled() else future.exception()
        if lost is None:
            yield future.result()
            return None
        self._deaths[job.index] += not self._under_way
        if self._deaths[job.index] < _DEATHS:
            self._suspects.append(job)
        else:
            yield failed(job, RuntimeError(f"it cost {_DEATHS} workers ({type(lost).__name__}: {lost})"))
        return lost
