"""The numba type of eight doubles, an LLVM vector, and what + - * / make of it."""

from __future__ import annotations

import operator
from typing import Any

from llvmlite import ir
from numba import types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import lower_builtin, models, register_model

WIDTH = 8
VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
UNDEFINED = ir.Constant(VECTOR, ir.Undefined)
FUSED = ("contract", "reassoc")


class Lanes(types.Type):
    """The numba type of eight doubles."""

    def __init__(self) -> None:
        super().__init__(name="Lanes")


lanes = Lanes()


@register_model(Lanes)
class _Model(models.PrimitiveModel):
    def __init__(self, manager: Any, numba_type: Any) -> None:
        super().__init__(manager, numba_type, VECTOR)


class _Arithmetic(AbstractTemplate):
    """Lanes with lanes, or with a float, give lanes."""

    def generic(self, args: Any, _keywords: Any) -> Any:
        if len(args) == 2 and lanes in args and all(a is lanes or a == types.float64 for a in args):
            return signature(lanes, *args)
        return None


def spread_over(builder: Any, value: Any) -> Any:
    """A float in all lanes; lanes as they are."""
    if value.type == VECTOR:
        return value
    one = builder.insert_element(UNDEFINED, value, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(one, UNDEFINED, ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), None))


def _define(symbol: Any, instruction: str) -> None:
    infer_global(symbol)(type(f"_{instruction}", (_Arithmetic,), {}))

    def lower(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        left, right = (spread_over(builder, arg) for arg in args)
        return getattr(builder, instruction)(left, right, flags=FUSED)

    for operands in ((lanes, lanes), (lanes, types.float64), (types.float64, lanes)):
        lower_builtin(symbol, *operands)(lower)


_define(operator.add, "fadd")
_define(operator.sub, "fsub")
_define(operator.mul, "fmul")
_define(operator.truediv, "fdiv")


def sum_of_halves(builder: Any, vector: Any, width: int) -> Any:
    """The first ``width`` elements of a vector plus the next ones."""
    undefined, mask = ir.Constant(vector.type, ir.Undefined), ir.VectorType(ir.IntType(32), width)
    picks = (list(range(width)), list(range(width, 2 * width)))
    low, high = (builder.shuffle_vector(vector, undefined, ir.Constant(mask, pick)) for pick in picks)
    return builder.fadd(low, high, flags=FUSED)
