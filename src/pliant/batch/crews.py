"""Who does the work: this process, a pool of processes of our own, or an executor of the user's."""

from __future__ import annotations

import multiprocessing
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

from pliant.batch.outcome import Job, Outcome
from pliant.batch.parcel import Parcel
from pliant.batch.work import carry_out_elsewhere, carry_out_here
from pliant.errors import InvalidParameter
from pliant.numerics.compute.chunks import processors

_MANY = 64  # workers that an executor is taken for which does not say how many it has, or may get more


class Crew(ABC):
    """Workers that take jobs.

    Parameters
    ----------
    workers
        How many there are, as far as that is known.
    width
        How many portions of jobs they have at a time.
    elsewhere
        Whether they are other processes.
    """

    workers: int = 1
    width: int = 1
    elsewhere: bool = False

    @abstractmethod
    def submit(self, parcel: Parcel, jobs: Sequence[Job], strict: bool) -> Future[list[Outcome]]:
        """Have jobs done, one after another by one worker."""

    def renewed(self) -> bool:
        """Whether there are workers again after all have been lost."""
        return False


class Here(Crew):
    """No others: the calling process does one job after another."""

    def submit(self, parcel: Parcel, jobs: Sequence[Job], strict: bool) -> Future[list[Outcome]]:
        future: Future[list[Outcome]] = Future()
        future.set_result(carry_out_here(parcel, jobs, strict))
        return future


class Given(Crew):
    """An executor of the user's."""

    def __init__(self, executor: Executor, workers: int, most: int = 0) -> None:
        self._executor, self.workers, self.width = executor, workers, 2 * max(workers, most)
        self.elsewhere = not isinstance(executor, ThreadPoolExecutor)
        self._work = carry_out_elsewhere if self.elsewhere else carry_out_here

    def submit(self, parcel: Parcel, jobs: Sequence[Job], strict: bool) -> Future[list[Outcome]]:
        return self._executor.submit(self._work, parcel, jobs, strict)


class Pool(Crew):
    """Processes of our own; where one is lost, all are replaced.

    Raises
    ------
    InvalidParameter
        None can be started.
    """

    elsewhere = True

    def __init__(self, workers: int) -> None:
        self.workers, self.width = workers, 2 * workers
        self._pool = self._started()

    def submit(self, parcel: Parcel, jobs: Sequence[Job], strict: bool) -> Future[list[Outcome]]:
        return self._pool.submit(carry_out_elsewhere, parcel, jobs, strict)

    def renewed(self) -> bool:
        self.close()
        self._pool = self._started()
        return True

    def close(self) -> None:
        """End the processes; what has not begun is not done."""
        self._pool.shutdown(wait=True, cancel_futures=True)

    def _started(self) -> ProcessPoolExecutor:
        pool = ProcessPoolExecutor(self.workers, _context())
        try:
            pool.submit(processors).result()
        except BrokenExecutor as error:
            raise InvalidParameter(
                "no worker process could be started: a script that runs a batch must do so under "
                "if __name__ == '__main__': (or pass executor=ThreadPoolExecutor())"
            ) from error
        return pool


@contextmanager
def crew_of(executor: Any, workers: int | None, jobs: int) -> Iterator[Crew]:
    """The crew for so many jobs.

    Parameters
    ----------
    executor
        An executor, a client of Dask's ``distributed``, or None.
    workers
        Without an executor: how many processes; 0 = this one. None = one a processor, and this one for a single job.
    jobs
        How many jobs there are.

    Raises
    ------
    InvalidParameter
        An executor that is none, a number of workers below zero.
    """
    if executor is not None:
        if workers is not None:
            raise InvalidParameter("an executor knows its workers: give either an executor or a number of workers")
        yield _given(executor)
        return
    if workers is not None and workers < 0:
        raise InvalidParameter(f"the number of workers is {workers}; it must be 0 (this process) or more")
    count = (0 if jobs < 2 else min(processors(), jobs)) if workers is None else min(workers, jobs)
    if count == 0:
        yield Here()
        return
    pool = Pool(count)
    try:
        yield pool
    finally:
        pool.close()


def _given(executor: Any) -> Crew:
    if isinstance(executor, Executor):
        return Given(executor, getattr(executor, "_max_workers", _MANY))
    if hasattr(executor, "get_executor") and hasattr(executor, "nthreads"):  # a client of Dask's
        fresh = executor.get_executor(pure=False)  # pure: a job sent again would get the error of its first time
        return Given(fresh, sum(executor.nthreads().values()) or _MANY, _MANY)
    raise InvalidParameter(
        f"a {type(executor).__name__} is no executor: pass one of concurrent.futures, or a client of dask.distributed"
    )


def _context() -> Any:
    """Processes that begin afresh: a fork would inherit locks of threads that it does not have."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["pliant.batch.work"])
    return context
