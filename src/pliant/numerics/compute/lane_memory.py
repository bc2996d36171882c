"""Eight doubles from and to memory: elements of C-ordered arrays, whose bounds the caller guarantees."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.errors import TypingError
from numba.extending import intrinsic

from pliant.numerics.compute.lane_type import VECTOR, WIDTH, lanes, spread_over, sum_of_halves


@intrinsic
def get(_typing: Any, array: Any, index: Any) -> Any:
    """One element of a C-ordered 1-D array, without Python's negative indices: they cost a branch a load."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        return builder.load(element_of(context, builder, array, *args))

    return array.dtype(array, types.intp), generate


@intrinsic
def put(_typing: Any, array: Any, index: Any, value: Any) -> Any:
    """Write one element of a C-ordered 1-D float64 array."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        builder.store(args[2], element_of(context, builder, array, *args[:2]))
        return context.get_dummy_value()

    return types.void(array, types.intp, types.float64), generate


@intrinsic
def load(_typing: Any, array: Any, index: Any) -> Any:
    """Eight consecutive elements of a C-ordered 1-D float64 array; the caller guarantees that they exist."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        return builder.load(address_of(context, builder, array, *args), align=8)

    return lanes(array, types.intp), generate


@intrinsic
def store(_typing: Any, array: Any, index: Any, value: Any) -> Any:
    """Write eight consecutive elements of a C-ordered 1-D float64 array."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        builder.store(args[2], address_of(context, builder, array, *args[:2]), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, lanes), generate


@intrinsic
def load_triples(_typing: Any, array: Any, index: Any) -> Any:
    """Eight consecutive (x, y, z) triples as the tuple of their x, y and z."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        start = address_of(context, builder, array, *args)
        parts = [builder.load(builder.gep(start, [ir.Constant(ir.IntType(64), i)]), align=8) for i in range(3)]
        columns = [_gather(builder, parts, [3 * n + axis for n in range(WIDTH)]) for axis in range(3)]
        return context.make_tuple(builder, sig.return_type, columns)

    return types.UniTuple(lanes, 3)(array, types.intp), generate


@intrinsic
def store_triples(_typing: Any, array: Any, index: Any, x: Any, y: Any, z: Any) -> Any:
    """Write eight consecutive (x, y, z) triples from their x, y and z."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        start = address_of(context, builder, array, *args[:2])
        for part in range(3):
            places = range(WIDTH * part, WIDTH * (part + 1))
            row = _gather(builder, args[2:], [WIDTH * (place % 3) + place // 3 for place in places])
            builder.store(row, builder.gep(start, [ir.Constant(ir.IntType(64), part)]), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, lanes, lanes, lanes), generate


@intrinsic
def clear(_typing: Any, array: Any, start: Any, stop: Any) -> Any:
    """Zero the elements from ``start`` to ``stop`` of a C-ordered array."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        length = builder.mul(builder.sub(args[2], args[1]), args[1].type(array.dtype.bitwidth // 8))
        cgutils.memset(builder, element_of(context, builder, array, *args[:2]), length, 0)
        return context.get_dummy_value()

    return types.void(array, types.intp, types.intp), generate


@intrinsic
def add_triple(_typing: Any, out: Any, place: Any, left: Any, i: Any, right: Any, j: Any) -> Any:
    """out[place:place + 3] = left[i:i + 3] + right[j:j + 3]; a fourth number is added too, and means nothing."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        four = ir.VectorType(ir.DoubleType(), WIDTH // 2).as_pointer()
        target, a, b = (
            builder.bitcast(address_of(context, builder, sig.args[n], *args[n : n + 2]), four) for n in (0, 2, 4)
        )
        builder.store(builder.fadd(builder.load(a, align=8), builder.load(b, align=8)), target, align=8)
        return context.get_dummy_value()

    return types.void(out, types.intp, left, types.intp, right, types.intp), generate


@intrinsic
def store_sum_of_halves(_typing: Any, array: Any, index: Any, value: Any) -> Any:
    """Write four consecutive elements: the first four lanes plus the last four."""

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        total = sum_of_halves(builder, args[2], WIDTH // 2)
        start = builder.bitcast(address_of(context, builder, array, *args[:2]), total.type.as_pointer())
        builder.store(total, start, align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, lanes), generate


def address_of(context: Any, builder: Any, array_type: Any, array: Any, index: Any) -> Any:
    """Where eight consecutive elements are."""
    return builder.bitcast(element_of(context, builder, array_type, array, index), VECTOR.as_pointer())


def element_of(context: Any, builder: Any, array_type: Any, array: Any, index: Any) -> Any:
    """Where an element is, by two instructions: what numba lays out for an array takes twenty, to be optimised away."""
    if array_type.layout != "C":
        raise TypingError(f"elements are counted in C order, and {array_type} is not in it")
    data = builder.extract_value(array, context.data_model_manager[array_type].get_field_position("data"))
    return builder.gep(data, [index])


def four_of(context: Any, builder: Any, array_type: Any, array: Any, at: Any, step: Any) -> list[Any]:
    """Four numbers of an array, ``step`` elements apart, each spread over all lanes."""
    places = [builder.add(at, builder.mul(step, at.type(place))) for place in range(4)]
    return [
        spread_over(builder, builder.load(element_of(context, builder, array_type, array, place))) for place in places
    ]


def _gather(builder: Any, parts: Any, picks: list[int]) -> Any:
    """Eight picked lanes of three vectors laid end to end."""
    integers = ir.VectorType(ir.IntType(32), WIDTH)
    near = [pick if pick < 2 * WIDTH else 0 for pick in picks]
    far = [WIDTH + pick - 2 * WIDTH if pick >= 2 * WIDTH else place for place, pick in enumerate(picks)]
    first = builder.shuffle_vector(parts[0], parts[1], ir.Constant(integers, near))
    return builder.shuffle_vector(first, parts[2], ir.Constant(integers, far))
