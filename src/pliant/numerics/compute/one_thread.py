"""One BLAS thread around small dense algebra: on busy processors several wait for one another, 100 times too long."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Keep NumPy's and SciPy's linear algebra in this thread, for matrices up to some hundred rows."""
    with _controller().limit(limits=1, user_api="blas"):
        yield


@cache
def _controller() -> Any:
    import scipy.linalg  # noqa: F401 -- NumPy and SciPy bring a library each: what is not loaded is not found
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
