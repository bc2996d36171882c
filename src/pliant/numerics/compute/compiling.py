"""How kernels are compiled: without the GIL, cached, with fused multiply-adds, NaN checks kept."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable
from threading import Timer
from typing import Any

import numba

_FUSED = {"contract", "reassoc"}

inlined: Callable[[Callable[..., Any]], Any] = numba.njit(nogil=True, fastmath=_FUSED, forceinline=True)
"""A piece of kernels."""


def kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function that Python drives over chunks, at its first call; the result is cached on disk.

    Where compiling takes longer than a second, a line on the terminal says so.
    """
    compiled = numba.njit(nogil=True, cache=True, fastmath=_FUSED)(function)

    @functools.wraps(function)
    def call(*arguments: Any) -> Any:
        if compiled.signatures:
            return compiled(*arguments)
        timer = Timer(1.0, _say)
        timer.daemon = True
        timer.start()
        try:
            return compiled(*arguments)
        finally:
            timer.cancel()

    return call


def _say() -> None:
    if sys.stderr.isatty():
        print("pliant: compiling for the first use on this machine ...", file=sys.stderr)  # noqa: T201
