"""How kernels are compiled: without the GIL, cached, with fused multiply-adds, NaN checks kept."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba

_FUSED = {"contract", "reassoc"}

kernel: Callable[[Callable[..., Any]], Any] = numba.njit(nogil=True, cache=True, fastmath=_FUSED)
"""A function that Python drives over chunks; compiled at its first call."""

inlined: Callable[[Callable[..., Any]], Any] = numba.njit(nogil=True, fastmath=_FUSED, forceinline=True)
"""A piece of kernels."""
