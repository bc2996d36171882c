"""How kernels are compiled: without the GIL, cached, with fused multiply-adds, NaN checks kept."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable
from threading import Timer
from typing import Any

import numba

_jit: Any = numba.njit  # whose declared types leave out the options on wrappers
_OPTIONS = {
    "nogil": True,
    "fastmath": {"contract", "reassoc"},
    "error_model": "numpy",  # division by zero gives inf or NaN, as in arrays: nothing asks before each one
    "no_cfunc_wrapper": True,
}

inlined: Callable[[Callable[..., Any]], Any] = _jit(forceinline=True, no_cpython_wrapper=True, **_OPTIONS)
"""A piece of kernels; Python cannot call it."""

called: Callable[[Callable[..., Any]], Any] = _jit(no_cpython_wrapper=True, **_OPTIONS)
"""The same, which need not be copied to where it is called: long pieces, so that compiling takes less."""


def kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function that Python drives over chunks, at its first call; the result is cached on disk.

    Where compiling takes longer than a second, a line on the terminal says so.
    """
    compiled = _jit(cache=True, **_OPTIONS)(function)

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
