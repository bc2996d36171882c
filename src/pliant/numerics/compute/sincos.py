"""Sine and cosine of eight lanes: numba would call the library's scalar ones, one lane after another.

The angle is reduced by multiples of pi / 2, kept in three doubles so that the rest is as exact as the angle (Cody &
Waite 1980); Taylor's series do what remains, |x| <= pi / 4, where their next term is below half a unit of the last
place. To 2 units of the last place, for angles up to a million.
"""

from __future__ import annotations

from math import factorial

from pliant.numerics.compute.compiling import inlined
from pliant.numerics.compute.lanes import fused, where_between, whole

_QUARTERS = 0.6366197723675814  # 2 / pi
_FIRST, _SECOND, _THIRD = 1.5707963267948966, 6.123233995736766e-17, -1.4973849048591833e-33  # their sum is pi / 2
_SIN = tuple((-1) ** k / factorial(2 * k + 1) for k in range(9))
_COS = tuple((-1) ** k / factorial(2 * k) for k in range(9))


@inlined
def _series(c, z):
    """The series' terms from the third on, divided by z squared."""
    return (((((z * c[8] + c[7]) * z + c[6]) * z + c[5]) * z + c[4]) * z + c[3]) * z + c[2]


@inlined
def _odd(n):
    """1 where a whole number is odd, else 0."""
    return n - 2.0 * whole(n * 0.5)


@inlined
def sincos(angle):
    """The sine and the cosine of each lane."""
    turns = whole(angle * _QUARTERS + 0.5)
    x = fused(turns, -_THIRD, fused(turns, -_SECOND, fused(turns, -_FIRST, angle)))
    z = x * x
    sine = x + x * z * (_series(_SIN, z) * z + _SIN[1])
    cosine = (1.0 - 0.5 * z) + z * z * _series(_COS, z)
    swapped = _odd(turns)
    first = where_between(swapped, 0.5, 1.5, cosine, sine)
    second = where_between(swapped, 0.5, 1.5, sine, cosine)
    sign_of_sine = 1.0 - 2.0 * _odd(whole(turns * 0.5))
    sign_of_cosine = 1.0 - 2.0 * _odd(whole((turns + 1.0) * 0.5))
    return first * sign_of_sine, second * sign_of_cosine
