"""Kernels written as text, as ``gaussian(sigma=50, scale=10) + 0.5 * bspline(support=20, scale=2)``."""

from __future__ import annotations

import ast
from collections.abc import Callable

from pliant.errors import InvalidParameter
from pliant.shape.bspline_kernel import BSplineKernel
from pliant.shape.kernels import (
    ExponentialKernel,
    GaussianKernel,
    InverseMultiquadricKernel,
    Kernel,
    MaternKernel,
    RationalQuadraticKernel,
)

KERNELS: dict[str, Callable[..., Kernel]] = {
    "gaussian": GaussianKernel,
    "exponential": ExponentialKernel,
    "matern": MaternKernel,
    "rational_quadratic": RationalQuadraticKernel,
    "inverse_multiquadric": InverseMultiquadricKernel,
    "bspline": BSplineKernel,
    "multi_scale": BSplineKernel.multi_scale,
}


def parse_kernel(text: str) -> Kernel:
    """The kernel that a text describes: kernels of :data:`KERNELS` with numbers, ``+`` and ``*``.

    Raises
    ------
    InvalidParameter
        Anything else; what was not understood is named.
    """
    try:
        found = _evaluated(ast.parse(text.strip(), mode="eval").body)
    except (SyntaxError, ValueError, OverflowError, RecursionError, MemoryError) as error:
        raise InvalidParameter(f"{_short(text)} is no kernel, as in gaussian(sigma=50, scale=10)") from error
    if not isinstance(found, Kernel):
        raise InvalidParameter(f"{_short(text)} is a number; a kernel is needed, as in gaussian(sigma=50, scale=10)")
    return found


def _evaluated(node: ast.expr) -> Kernel | float:
    match node:
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            one, two = _evaluated(left), _evaluated(right)
            if isinstance(one, Kernel) and isinstance(two, Kernel):
                return one + two
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            one, two = _evaluated(left), _evaluated(right)
            if isinstance(one, Kernel):
                return one * two
            if isinstance(two, Kernel):
                return two * one
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=named) if name in KERNELS:
            return _made(name, [_number(each) for each in arguments], {str(k.arg): _number(k.value) for k in named})
        case ast.Constant(value=int() | float()):
            return _number(node)
    raise InvalidParameter(
        f"{_short(ast.unparse(node))} is no kernel; there are: {', '.join(KERNELS)}, joined by + and *"
    )


def _made(name: str, values: list[float], named: dict[str, float]) -> Kernel:
    if "levels" in named:
        if not float(named["levels"]).is_integer():
            raise InvalidParameter(f"{name} has a whole number of levels, not {named['levels']:g}")
        named["levels"] = int(named["levels"])
    try:
        return KERNELS[name](*values, **named)
    except TypeError as error:
        given = ", ".join([*(f"{v:g}" for v in values), *(f"{k}={v:g}" for k, v in named.items())])
        wanted = "support and scale" if name in ("bspline", "multi_scale") else "sigma and scale"
        raise InvalidParameter(f"{name}({given}): this kernel has {wanted}") from error


def _number(node: ast.expr) -> float:
    match node:
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            return value
        case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=int() | float() as value)):
            return -value
    raise InvalidParameter(f"{_short(ast.unparse(node))} is not a number")


def _short(text: str) -> str:
    """A text as it is quoted in a message: no longer than a line."""
    return repr(text if len(text) <= 80 else f"{text[:77]}...")
