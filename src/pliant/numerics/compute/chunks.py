"""One thread-pool helper drives every kernel over chunks of points."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import cache
from threading import local

CHUNK = 65_536  # points a chunk: 1.5 MB of coordinates, so that a chunk's input and output stay in cache


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


_here = local()  # whether this thread is one of the pool's


def _begin() -> None:
    _here.working = True


@cache
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(max_workers=processors(), thread_name_prefix="pliant", initializer=_begin)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_pool.cache_clear)  # a forked child has none of its parent's threads


@contextmanager
def in_this_thread() -> Iterator[None]:
    """Spread nothing over processors: for one of several processes that share them."""
    before = getattr(_here, "working", False)
    _here.working = True
    try:
        yield
    finally:
        _here.working = before


def for_chunks(work: Callable[[int, int], None], count: int, chunk: int = CHUNK) -> None:
    """Call ``work(start, stop)`` for consecutive pieces of ``range(count)``, on all processors.

    ``work`` must release the GIL to gain anything, and write to places of its own. Small counts run in the
    calling thread, and so does all that a piece of work starts in turn: the pool never waits for itself.
    """
    starts = range(0, count, chunk)
    if len(starts) < 2 or processors() == 1 or getattr(_here, "working", False):
        for start in starts:
            work(start, min(start + chunk, count))
        return
    for done in [_pool().submit(work, start, min(start + chunk, count)) for start in starts]:
        done.result()
