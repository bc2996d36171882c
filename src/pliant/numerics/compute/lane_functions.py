"""Angles, logarithms and roots of eight lanes.

For the first two numba would call the library's scalar ones, one lane after another. Both begin with a quotient that
brings the argument near one, by octants for the angle and by powers of two for the logarithm; what remains is a
polynomial through Chebyshev's points, exact to 3e-18 of its value before rounding. To 4 units of the last place.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.extending import intrinsic

from pliant.numerics.compute.compiling import inlined
from pliant.numerics.compute.lane_type import VECTOR, WIDTH, lanes

_ARCTAN = (
    *(1.0, -0.3333333333333312, 0.19999999999940302, -0.14285714279196723, 0.11111110742493366, -0.0909089674476956),
    *(0.07692044260409477, -0.06662940282503498, 0.058467980544001784, -0.05034754340062874, 0.037956699959950484),
    -0.01779629742825221,
)  # arctan(u) / u, of u squared up to tan²(pi / 8)
_ARTANH = (
    *(1.0, 0.33333333333333814, 0.19999999999653387, 0.14285714380244283, 0.11111098508506591, 0.09091817855038617),
    *(0.07656194818639872, 0.07405675483047734),
)  # artanh(f) / f, of f squared up to ((sqrt(2) - 1) / (sqrt(2) + 1))²
_TAN_EIGHTH = 0.41421356237309503  # tan(pi / 8)
_EIGHTH, _QUARTER, _HALF = 0.7853981633974483, 1.5707963267948966, 3.141592653589793
_ROOT_TWO, _LOG_TWO = 1.4142135623730951, 0.6931471805599453

_WORDS = ir.VectorType(ir.IntType(64), WIDTH)


@intrinsic
def where_less(_typing: Any, left: Any, right: Any, yes: Any, no: Any) -> Any:
    """``yes`` in the lanes where left < right, ``no`` in the others."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        return builder.select(builder.fcmp_ordered("<", args[0], args[1]), args[2], args[3])

    return lanes(lanes, lanes, lanes, lanes), generate


@intrinsic
def magnitude(_typing: Any, value: Any) -> Any:
    """The lanes without their signs."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        bits = builder.and_(builder.bitcast(args[0], _WORDS), _words((1 << 63) - 1))
        return builder.bitcast(bits, VECTOR)

    return lanes(lanes), generate


@intrinsic
def with_sign(_typing: Any, value: Any, sign: Any) -> Any:
    """``value``, not negative, with the signs of other lanes."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        sign_bits = builder.and_(builder.bitcast(args[1], _WORDS), _words(-(1 << 63)))
        return builder.bitcast(builder.or_(builder.bitcast(args[0], _WORDS), sign_bits), VECTOR)

    return lanes(lanes, lanes), generate


@intrinsic
def exponent(_typing: Any, value: Any) -> Any:
    """The power of two that each positive lane begins with, as a whole number."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        biased = builder.lshr(builder.bitcast(args[0], _WORDS), _words(52))
        return builder.sitofp(builder.sub(biased, _words(1023)), VECTOR)

    return lanes(lanes), generate


@intrinsic
def mantissa(_typing: Any, value: Any) -> Any:
    """Each positive lane divided by its power of two: in [1, 2)."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        bits = builder.and_(builder.bitcast(args[0], _WORDS), _words((1 << 52) - 1))
        return builder.bitcast(builder.or_(bits, _words(1023 << 52)), VECTOR)

    return lanes(lanes), generate


@intrinsic
def inverse_root_guess(_typing: Any, value: Any) -> Any:
    """One over the square root of positive lanes to 3.5 %, finite where a lane is 0: half the exponent, by its bits."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        halved = builder.lshr(builder.bitcast(args[0], _WORDS), _words(1))
        return builder.bitcast(builder.sub(_words(0x5FE6EB50C7B537A9), halved), VECTOR)

    return lanes(lanes), generate


@inlined
def quick_root(square):
    """The square root, to 2 units of the last place: two steps of Newton's method, one of third order.

    Twice as fast as the processor's own, which lets multiplications wait. The guess: Lomont (2003).
    """
    square = square + 1e-300  # at 0 the guess squared would overflow
    half = square * 0.5
    inverse = inverse_root_guess(square)
    inverse = inverse * (1.5 - half * inverse * inverse)
    inverse = inverse * (1.5 - half * inverse * inverse)
    near = square * inverse
    left = 1.0 - near * inverse
    return near + near * left * (left * 0.375 + 0.5)


@inlined
def angle(sine, cosine, zero):
    """The angle in [0, pi] whose sine and cosine are proportional to two lanes, sine >= 0; 0 where both are 0.

    ``zero`` is ``spread(0.0)``.
    """
    flat = magnitude(cosine)
    low, high = flat * _TAN_EIGHTH, flat * (1.0 / _TAN_EIGHTH)
    above, below = sine - flat, sine + flat
    top = where_less(low, sine, where_less(high, sine, zero - flat, above), sine)
    bottom = where_less(low, sine, where_less(high, sine, sine, below), flat)
    base = where_less(low, sine, where_less(high, sine, zero + _QUARTER, zero + _EIGHTH), zero)
    u = top / where_less(zero, bottom, bottom, zero + 1.0)
    z = u * u
    c = _ARCTAN
    series = (((((z * c[11] + c[10]) * z + c[9]) * z + c[8]) * z + c[7]) * z + c[6]) * z + c[5]
    series = ((((series * z + c[4]) * z + c[3]) * z + c[2]) * z + c[1]) * z
    turned = base + (u + u * series)
    return where_less(cosine, zero, _HALF - turned, turned)


@inlined
def log_ratio(top, bottom):
    """The logarithm of top / bottom, both positive and not denormal."""
    power = exponent(top) - exponent(bottom)
    a, b = mantissa(top), mantissa(bottom)
    large = where_less(b * _ROOT_TWO, a, a * 0.5, a)
    power = where_less(b * _ROOT_TWO, a, power + 1.0, power)
    small = where_less(a * _ROOT_TWO, b, a * 2.0, large)
    power = where_less(a * _ROOT_TWO, b, power - 1.0, power)
    f = (small - b) / (small + b)
    z = f * f
    c = _ARTANH
    series = ((((((z * c[7] + c[6]) * z + c[5]) * z + c[4]) * z + c[3]) * z + c[2]) * z + c[1]) * z
    return power * _LOG_TWO + 2.0 * (f + f * series)


def _words(value: int) -> Any:
    return ir.Constant(_WORDS, [value] * WIDTH)
