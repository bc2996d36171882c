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
_PORTION = 0.05  # seconds of work that are sent at once: sending takes a millisecond or two
_MOST = 64  # jobs that are


def outcomes(crew: Crew, parcel: Parcel, jobs: Iterable[Job], strict: bool) -> Iterator[Outcome]:
    """Have jobs done.

    Small ones travel several at a time. What a worker raises is an outcome already; what comes out of a future beside
    that says that a worker was lost. Its jobs are then done again, one at a time, to find which of them it was; writing
    is atomic, so that a half-done one leaves nothing. A job that loses its worker again and again fails. Where all
    workers are lost with one, so is what they had.
    """
    return _Dispatch(crew, parcel, strict).run(deque(jobs))


class _Dispatch:
    def __init__(self, crew: Crew, parcel: Parcel, strict: bool) -> None:
        self._crew, self._parcel, self._strict = crew, parcel, strict
        self._under_way: dict[Future[list[Outcome]], list[Job]] = {}
        self._done: SimpleQueue[Future[list[Outcome]]] = SimpleQueue()
        self._suspects: deque[Job] = deque()
        self._deaths: Counter[int] = Counter()
        self._pace = float("inf")  # seconds a job; nobody knows before the first is done

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
            if len(self._under_way) >= self._room():
                return None
            queue, count = (self._suspects, 1) if self._suspects else (waiting, self._portion(len(waiting)))
            jobs = [queue[i] for i in range(count)]
            try:
                future = self._crew.submit(self._parcel, jobs, self._strict)
            except RuntimeError as error:  # it is broken, or was shut down
                return error if isinstance(error, BrokenExecutor) else BrokenExecutor(str(error))
            self._under_way[future] = [queue.popleft() for _ in jobs]
            future.add_done_callback(self._done.put)
        return None

    def _room(self) -> int:
        """How many portions may be under way: one a worker, as long as nobody knows how much work a job is."""
        if self._suspects:
            return 1
        return self._crew.workers if self._pace == float("inf") else self._crew.width

    def _portion(self, left: int) -> int:
        """How many of the jobs that are left to send at once, so that in the end all workers have some."""
        if not self._crew.elsewhere:
            return 1
        return max(1, min(_MOST, int(_PORTION / self._pace), left // (4 * self._crew.workers)))

    def _received(self) -> Generator[Outcome, None, BaseException | None]:
        """The next outcomes, or the error that took a worker away."""
        future = self._done.get()
        jobs = self._under_way.pop(future)
        lost = CancelledError("the job was cancelled") if future.cancelled() else future.exception()
        if lost is None:
            found = future.result()
            last = max(1e-6, sum(each.seconds for each in found) / len(found))
            self._pace = min(last, 0.8 * self._pace + 0.2 * last)  # the first of a worker may have compiled much
            yield from found
            return None
        alone = len(jobs) == 1 and not self._under_way
        for job in jobs:
            self._deaths[job.index] += alone
            if self._deaths[job.index] < _DEATHS:
                self._suspects.append(job)
            else:
                yield failed(job, RuntimeError(f"it cost {_DEATHS} workers ({type(lost).__name__}: {lost})"))
        return lost
