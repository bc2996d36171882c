"""One BLAS thread around small dense algebra: on busy processors several wait for one another, 100 times too long."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import Lock
from typing import Any


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Keep NumPy's and SciPy's linear algebra in its callers' threads, for matrices up to some hundred rows.

    The number of BLAS threads is one for the whole process: the first who is here lowers it, the last to go puts it
    back.
    """
    _limit.enter()
    try:
        yield
    finally:
        _limit.leave()


class _Limit:
    """Those who want one thread, counted."""

    def __init__(self) -> None:
        self._lock, self._inside = Lock(), 0
        self._before: list[tuple[Any, int]] = []

    def enter(self) -> None:
        with self._lock:
            if not self._inside:
                self._before = [(library, library.num_threads) for library in _libraries()]
                _set([(library, 1) for library, _ in self._before])
            self._inside += 1

    def leave(self) -> None:
        with self._lock:
            self._inside -= 1
            if not self._inside:
                _set(self._before)


_limit = _Limit()


def _set(counts: list[tuple[Any, int]]) -> None:
    """Give libraries their numbers of threads, whichever thread asked the last time."""
    for library, count in counts:
        forget = getattr(library, "clear_controlling_thread", lambda **_: None)
        forget(force=True)  # else a library listens to the first thread that has set its number, and to no other
        library.set_num_threads(count)
        forget(force=True)


@cache
def _libraries() -> list[Any]:
    import scipy.linalg  # noqa: F401 -- NumPy and SciPy bring a library each: what is not loaded is not found
    from threadpoolctl import ThreadpoolController

    return list(ThreadpoolController().select(user_api="blas").lib_controllers)
