"""Arithmetic of eight doubles beyond their operators: choices, roots, sums, and products with numbers in memory."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from pliant.numerics.compute.lane_memory import four_of
from pliant.numerics.compute.lane_type import FUSED, VECTOR, WIDTH, lanes, spread_over, sum_of_halves


@intrinsic
def spread(_typing: Any, value: Any) -> Any:
    """The same float in all lanes."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        return spread_over(builder, args[0])

    return lanes(types.float64), generate


@intrinsic
def spread_halves(_typing: Any, low: Any, high: Any) -> Any:
    """One float in the first four lanes, another in the last four."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        low, high = (spread_over(builder, arg) for arg in args)
        picks = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0, 1, 2, 3, 12, 13, 14, 15])
        return builder.shuffle_vector(low, high, picks)

    return lanes(types.float64, types.float64), generate


@intrinsic
def clamp(_typing: Any, value: Any, low: Any, high: Any) -> Any:
    """The value of each lane, or the bound that it passes."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        low, high = spread_over(builder, args[1]), spread_over(builder, args[2])
        raised = builder.select(builder.fcmp_ordered(">", args[0], low), args[0], low)
        return builder.select(builder.fcmp_ordered("<", raised, high), raised, high)

    return lanes(lanes, types.float64, types.float64), generate


@intrinsic
def where_between(_typing: Any, value: Any, low: Any, high: Any, inside: Any, outside: Any) -> Any:
    """``inside`` in the lanes where low <= value <= high, ``outside``, lanes or a float, in the others."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        low, high, outside = (spread_over(builder, args[i]) for i in (1, 2, 4))
        above = builder.fcmp_ordered(">=", args[0], low)
        below = builder.fcmp_ordered("<=", args[0], high)
        return builder.select(builder.and_(above, below), args[3], outside)

    return lanes(lanes, types.float64, types.float64, lanes, outside), generate


@intrinsic
def whole(_typing: Any, value: Any) -> Any:
    """The largest whole number not above each lane."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        floor_type = ir.FunctionType(VECTOR, [VECTOR])
        return builder.call(cgutils.get_or_insert_function(builder.module, floor_type, "llvm.floor.v8f64"), args)

    return lanes(lanes), generate


@intrinsic
def root(_typing: Any, value: Any) -> Any:
    """The square root of each lane."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        root_type = ir.FunctionType(VECTOR, [VECTOR])
        return builder.call(cgutils.get_or_insert_function(builder.module, root_type, "llvm.sqrt.v8f64"), args)

    return lanes(lanes), generate


@intrinsic
def fused(_typing: Any, a: Any, b: Any, c: Any) -> Any:
    """A * b + c with one rounding, which no optimisation reorders: for sums that cancel; b is a float."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        fused_type = ir.FunctionType(VECTOR, [VECTOR] * 3)
        function = cgutils.get_or_insert_function(builder.module, fused_type, "llvm.fma.v8f64")
        return builder.call(function, [args[0], spread_over(builder, args[1]), args[2]])

    return lanes(lanes, types.float64, lanes), generate


@intrinsic
def cubic(_typing: Any, array: Any, at: Any, step: Any, t: Any) -> Any:
    """A cubic polynomial by Horner's rule; its coefficients, lowest power first, stand ``step`` elements apart."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        constant, linear, square, cube = four_of(context, builder, array, *args[:3])
        value = cube
        for coefficient in (square, linear, constant):
            value = builder.fadd(builder.fmul(value, args[3], flags=FUSED), coefficient, flags=FUSED)
        return value

    return lanes(array, types.intp, types.intp, lanes), generate


@intrinsic
def affine(_typing: Any, array: Any, row: Any, x: Any, y: Any, z: Any) -> Any:
    """One coordinate of eight points after an affine map: a row of a C-ordered matrix (rows, 4) times (x, y, z, 1)."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        integer = args[1].type
        row = four_of(context, builder, array, args[0], builder.mul(args[1], integer(4)), integer(1))
        return builder.fadd(_weighted(builder, args[2:], row), row[3], flags=FUSED)

    return lanes(array, types.intp, lanes, lanes, lanes), generate


@intrinsic
def weighted(_typing: Any, array: Any, at: Any, step: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
    """The sum of four lanes, each times a number; the numbers stand ``step`` elements apart."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        return _weighted(builder, args[3:], four_of(context, builder, array, *args[:3]))

    return lanes(array, types.intp, types.intp, lanes, lanes, lanes, lanes), generate


@intrinsic
def total(_typing: Any, value: Any) -> Any:
    """The sum over the lanes, halves first."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        vector, width = args[0], WIDTH
        while width > 1:
            width //= 2
            vector = sum_of_halves(builder, vector, width)
        return builder.extract_element(vector, ir.Constant(ir.IntType(32), 0))

    return types.float64(lanes), generate


def _weighted(builder: Any, values: Any, factors: Any) -> Any:
    total, *rest = (builder.fmul(value, factor, flags=FUSED) for value, factor in zip(values, factors, strict=False))
    for product in rest:
        total = builder.fadd(total, product, flags=FUSED)
    return total
