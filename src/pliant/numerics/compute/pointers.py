"""Bare addresses of arrays for numba kernels.

Numba counts references to arrays wherever they are passed on, which costs more than small pieces of a kernel do. A
pointer is not counted, nor are its indices checked for being negative; whoever takes one keeps the array alive:
arguments of the kernel are, arrays that it makes itself are not.
"""

from __future__ import annotations

from typing import Any

from numba import types
from numba.extending import intrinsic


@intrinsic
def pointer(_typing: Any, array: Any) -> Any:
    """The address of a C-ordered array's first element, to be read and written by flat index."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        return context.make_array(array)(context, builder, value=args[0]).data

    return types.CPointer(array.dtype)(array), generate
