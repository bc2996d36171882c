"""Eight doubles at a time: a vector type for numba kernels.

Numba leaves straight-line code over a few values scalar. ``Lanes`` is an LLVM vector of eight doubles that kernels
add and multiply like numbers; a float operand is spread over all lanes, and a product that is added becomes one
fused multiply-add. Where the processor has AVX-512 a value is one register, elsewhere LLVM splits it.
"""

from __future__ import annotations

import operator
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.errors import TypingError
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

WIDTH = 8
_VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
_UNDEFINED = ir.Constant(_VECTOR, ir.Undefined)
_FUSED = ("contract", "reassoc")


class Lanes(types.Type):
    """The numba type of eight doubles."""

    def __init__(self) -> None:
        super().__init__(name="Lanes")


lanes = Lanes()


@register_model(Lanes)
class _Model(models.PrimitiveModel):
    def __init__(self, manager: Any, numba_type: Any) -> None:
        super().__init__(manager, numba_type, _VECTOR)


class _Arithmetic(AbstractTemplate):
    """Lanes with lanes, or with a float, give lanes."""

    def generic(self, args: Any, _keywords: Any) -> Any:
        if len(args) == 2 and lanes in args and all(a is lanes or a == types.float64 for a in args):
            return signature(lanes, *args)
        return None


def _spread(builder: Any, value: Any) -> Any:
    if value.type == _VECTOR:
        return value
    one = builder.insert_element(_UNDEFINED, value, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(one, _UNDEFINED, ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), None))


def _define(symbol: Any, instruction: str) -> None:
    infer_global(symbol)(type(f"_{instruction}", (_Arithmetic,), {}))

    def lower(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        left, right = (_spread(builder, arg) for arg in args)
        return getattr(builder, instruction)(left, right, flags=_FUSED)

    for operands in ((lanes, lanes), (lanes, types.float64), (types.float64, lanes)):
        lower_builtin(symbol, *operands)(lower)


_define(operator.add, "fadd")
_define(operator.sub, "fsub")
_define(operator.mul, "fmul")
_define(operator.truediv, "fdiv")


@intrinsic
def spread(_typing: Any, value: Any) -> Any:
    """The same float in all lanes."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        return _spread(builder, args[0])

    return lanes(types.float64), generate


@intrinsic
def load(_typing: Any, array: Any, index: Any) -> Any:
    """Eight consecutive elements of a C-ordered 1-D float64 array; the caller guarantees that they exist."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        return builder.load(_address(context, builder, array, *args), align=8)

    return lanes(array, types.intp), generate


@intrinsic
def store(_typing: Any, array: Any, index: Any, value: Any) -> Any:
    """Write eight consecutive elements of a C-ordered 1-D float64 array."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        builder.store(args[2], _address(context, builder, array, *args[:2]), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, lanes), generate


@intrinsic
def load_triples(_typing: Any, array: Any, index: Any) -> Any:
    """Eight consecutive (x, y, z) triples as the tuple of their x, y and z."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        start = _address(context, builder, array, *args)
        parts = [builder.load(builder.gep(start, [ir.Constant(ir.IntType(64), i)]), align=8) for i in range(3)]
        columns = [_gather(builder, parts, [3 * n + axis for n in range(WIDTH)]) for axis in range(3)]
        return context.make_tuple(builder, sig.return_type, columns)

    return types.UniTuple(lanes, 3)(array, types.intp), generate


@intrinsic
def store_triples(_typing: Any, array: Any, index: Any, x: Any, y: Any, z: Any) -> Any:
    """Write eight consecutive (x, y, z) triples from their x, y and z."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        start = _address(context, builder, array, *args[:2])
        for part in range(3):
            places = range(WIDTH * part, WIDTH * (part + 1))
            row = _gather(builder, args[2:], [WIDTH * (place % 3) + place // 3 for place in places])
            builder.store(row, builder.gep(start, [ir.Constant(ir.IntType(64), part)]), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, lanes, lanes, lanes), generate


@intrinsic
def clamp(_typing: Any, value: Any, low: Any, high: Any) -> Any:
    """The value of each lane, or the bound that it passes."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        low, high = _spread(builder, args[1]), _spread(builder, args[2])
        raised = builder.select(builder.fcmp_ordered(">", args[0], low), args[0], low)
        return builder.select(builder.fcmp_ordered("<", raised, high), raised, high)

    return lanes(lanes, types.float64, types.float64), generate


@intrinsic
def where_between(_typing: Any, value: Any, low: Any, high: Any, inside: Any, outside: Any) -> Any:
    """``inside`` in the lanes where low <= value <= high, ``outside``, lanes or a float, in the others."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        low, high, outside = (_spread(builder, args[i]) for i in (1, 2, 4))
        above = builder.fcmp_ordered(">=", args[0], low)
        below = builder.fcmp_ordered("<=", args[0], high)
        return builder.select(builder.and_(above, below), args[3], outside)

    return lanes(lanes, types.float64, types.float64, lanes, outside), generate


@intrinsic
def whole(_typing: Any, value: Any) -> Any:
    """The largest whole number not above each lane."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        floor_type = ir.FunctionType(_VECTOR, [_VECTOR])
        return builder.call(cgutils.get_or_insert_function(builder.module, floor_type, "llvm.floor.v8f64"), args)

    return lanes(lanes), generate


@intrinsic
def fused(_typing: Any, a: Any, b: Any, c: Any) -> Any:
    """A * b + c with one rounding, which no optimisation reorders: for sums that cancel; b is a float."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        fused_type = ir.FunctionType(_VECTOR, [_VECTOR] * 3)
        function = cgutils.get_or_insert_function(builder.module, fused_type, "llvm.fma.v8f64")
        return builder.call(function, [args[0], _spread(builder, args[1]), args[2]])

    return lanes(lanes, types.float64, lanes), generate


@intrinsic
def root(_typing: Any, value: Any) -> Any:
    """The square root of each lane."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        root_type = ir.FunctionType(_VECTOR, [_VECTOR])
        return builder.call(cgutils.get_or_insert_function(builder.module, root_type, "llvm.sqrt.v8f64"), args)

    return lanes(lanes), generate


@intrinsic
def cubic(_typing: Any, array: Any, at: Any, step: Any, t: Any) -> Any:
    """A cubic polynomial by Horner's rule; its coefficients, lowest power first, stand ``step`` elements apart."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        constant, linear, square, cube = _four(context, builder, array, *args[:3])
        value = cube
        for coefficient in (square, linear, constant):
            value = builder.fadd(builder.fmul(value, args[3], flags=_FUSED), coefficient, flags=_FUSED)
        return value

    return lanes(array, types.intp, types.intp, lanes), generate


@intrinsic
def affine(_typing: Any, array: Any, row: Any, x: Any, y: Any, z: Any) -> Any:
    """One coordinate of eight points after an affine map: a row of a C-ordered matrix (rows, 4) times (x, y, z, 1)."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        integer = args[1].type
        row = _four(context, builder, array, args[0], builder.mul(args[1], integer(4)), integer(1))
        return builder.fadd(_weighted(builder, args[2:], row), row[3], flags=_FUSED)

    return lanes(array, types.intp, lanes, lanes, lanes), generate


@intrinsic
def weighted(_typing: Any, array: Any, at: Any, step: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
    """The sum of four lanes, each times a number; the numbers stand ``step`` elements apart."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        return _weighted(builder, args[3:], _four(context, builder, array, *args[:3]))

    return lanes(array, types.intp, types.intp, lanes, lanes, lanes, lanes), generate


@intrinsic
def clear(_typing: Any, array: Any, start: Any, stop: Any) -> Any:
    """Zero the elements from ``start`` to ``stop`` of a C-ordered array."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        length = builder.mul(builder.sub(args[2], args[1]), args[1].type(array.dtype.bitwidth // 8))
        cgutils.memset(builder, _element(context, builder, array, *args[:2]), length, 0)
        return context.get_dummy_value()

    return types.void(array, types.intp, types.intp), generate


@intrinsic
def get(_typing: Any, array: Any, index: Any) -> Any:
    """One element of a C-ordered 1-D array, without Python's negative indices: they cost a branch a load."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        return builder.load(_element(context, builder, array, *args))

    return array.dtype(array, types.intp), generate


@intrinsic
def put(_typing: Any, array: Any, index: Any, value: Any) -> Any:
    """Write one element of a C-ordered 1-D float64 array."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        builder.store(args[2], _element(context, builder, array, *args[:2]))
        return context.get_dummy_value()

    return types.void(array, types.intp, types.float64), generate


@intrinsic
def spread_halves(_typing: Any, low: Any, high: Any) -> Any:
    """One float in the first four lanes, another in the last four."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        low, high = (_spread(builder, arg) for arg in args)
        picks = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0, 1, 2, 3, 12, 13, 14, 15])
        return builder.shuffle_vector(low, high, picks)

    return lanes(types.float64, types.float64), generate


@intrinsic
def store_sum_of_halves(_typing: Any, array: Any, index: Any, value: Any) -> Any:
    """Write four consecutive elements: the first four lanes plus the last four."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        total = _sum_of_halves(builder, args[2], WIDTH // 2)
        start = builder.bitcast(_address(context, builder, array, *args[:2]), total.type.as_pointer())
        builder.store(total, start, align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, lanes), generate


@intrinsic
def add_triple(_typing: Any, out: Any, place: Any, left: Any, i: Any, right: Any, j: Any) -> Any:
    """out[place:place + 3] = left[i:i + 3] + right[j:j + 3]; a fourth number is added too, and means nothing."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        four = ir.VectorType(ir.DoubleType(), WIDTH // 2).as_pointer()
        target, a, b = (
            builder.bitcast(_address(context, builder, sig.args[n], *args[n : n + 2]), four) for n in (0, 2, 4)
        )
        builder.store(builder.fadd(builder.load(a, align=8), builder.load(b, align=8)), target, align=8)
        return context.get_dummy_value()

    return types.void(out, types.intp, left, types.intp, right, types.intp), generate


@intrinsic
def total(_typing: Any, value: Any) -> Any:
    """The sum over the lanes, halves first."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        vector, width = args[0], WIDTH
        while width > 1:
            width //= 2
            vector = _sum_of_halves(builder, vector, width)
        return builder.extract_element(vector, ir.Constant(ir.IntType(32), 0))

    return types.float64(lanes), generate


def _sum_of_halves(builder: Any, vector: Any, width: int) -> Any:
    """The first ``width`` elements of a vector plus the next ones."""
    undefined, mask = ir.Constant(vector.type, ir.Undefined), ir.VectorType(ir.IntType(32), width)
    picks = (list(range(width)), list(range(width, 2 * width)))
    low, high = (builder.shuffle_vector(vector, undefined, ir.Constant(mask, pick)) for pick in picks)
    return builder.fadd(low, high, flags=_FUSED)


def _address(context: Any, builder: Any, array_type: Any, array: Any, index: Any) -> Any:
    return builder.bitcast(_element(context, builder, array_type, array, index), _VECTOR.as_pointer())


def _four(context: Any, builder: Any, array_type: Any, array: Any, at: Any, step: Any) -> list[Any]:
    """Four numbers of an array, ``step`` elements apart, each spread over all lanes."""
    places = [builder.add(at, builder.mul(step, at.type(place))) for place in range(4)]
    return [_spread(builder, builder.load(_element(context, builder, array_type, array, place))) for place in places]


def _weighted(builder: Any, values: Any, factors: Any) -> Any:
    total, *rest = (builder.fmul(value, factor, flags=_FUSED) for value, factor in zip(values, factors, strict=False))
    for product in rest:
        total = builder.fadd(total, product, flags=_FUSED)
    return total


def _element(context: Any, builder: Any, array_type: Any, array: Any, index: Any) -> Any:
    """Where an element is, by two instructions: what numba lays out for an array takes twenty, to be optimised away."""
    if array_type.layout != "C":
        raise TypingError(f"elements are counted in C order, and {array_type} is not in it")
    data = builder.extract_value(array, context.data_model_manager[array_type].get_field_position("data"))
    return builder.gep(data, [index])


def _gather(builder: Any, parts: Any, picks: list[int]) -> Any:
    """Eight picked lanes of three vectors laid end to end."""
    integers = ir.VectorType(ir.IntType(32), WIDTH)
    near = [pick if pick < 2 * WIDTH else 0 for pick in picks]
    far = [WIDTH + pick - 2 * WIDTH if pick >= 2 * WIDTH else place for place, pick in enumerate(picks)]
    first = builder.shuffle_vector(parts[0], parts[1], ir.Constant(integers, near))
    return builder.shuffle_vector(first, parts[2], ir.Constant(integers, far))
