"""Text to numbers at the speed of memory.

Numbers come out correctly rounded. Short ones need one exact multiplication or division (Clinger 1990); for the
others the decimal mantissa is multiplied by a truncated 64-bit power of ten, which leaves the sum of the errors below
two units of the product's upper half, and decides the rounding in all but one case in 500 (after Lemire 2021). Whatever
stays undecided, and whatever is no plain number, comes out as NaN for Python's own ``float`` to judge.

No kernel here uses relaxed floating-point arithmetic: exactness is the point.
"""

from __future__ import annotations

import numba
import numpy as np

_EXPONENT = 100
_SCALE = 512


def _power_of_ten(exponent: int) -> tuple[int, int]:
    """The leading 64 bits of a power of ten, truncated, and the power of two that they are multiplied by."""
    bits = 0 if exponent >= 0 else 64 - 4 * exponent
    number = 10**exponent if exponent >= 0 else (1 << bits) // 10**-exponent
    drop = number.bit_length() - 64
    return (number >> drop if drop >= 0 else number << -drop), drop - bits


_POWERS = [_power_of_ten(exponent) for exponent in range(-_EXPONENT, _EXPONENT + 1)]
_TENS = np.array([leading for leading, _ in _POWERS], np.uint64)
_TWOS = np.array([two for _, two in _POWERS], np.int64)
_EXACT = 10.0 ** np.arange(23)
_LADDER = np.ldexp(1.0, np.arange(-_SCALE, _SCALE))
_U0, _U1, _U10, _U11, _U32 = (np.uint64(value) for value in (0, 1, 10, 11, 32))
_LOW32 = np.uint64(0xFFFFFFFF)
_TOP = np.uint64(1 << 63)
_EXACT_MANTISSA = np.uint64(1 << 53)
_ROOM = np.uint64((1 << 63) // 5 - 2)  # a mantissa below it takes one more digit


@numba.njit(nogil=True, cache=True)
def _upper_half(x, y):  # type: ignore[no-untyped-def]
    """The upper 64 bits of a 128-bit product."""
    a, b, c, d = x >> _U32, x & _LOW32, y >> _U32, y & _LOW32
    ad, bc = a * d, b * c
    middle = (b * d >> _U32) + (ad & _LOW32) + (bc & _LOW32)
    return a * c + (ad >> _U32) + (bc >> _U32) + (middle >> _U32)


@numba.njit(nogil=True, cache=True)
def _scaled(mantissa, exponent, whole):  # type: ignore[no-untyped-def]
    """A mantissa times a power of ten, correctly rounded, or NaN; ``whole`` = no digit was left out."""
    if mantissa == _U0:
        return 0.0 if whole else np.nan
    if whole and mantissa <= _EXACT_MANTISSA and -22 <= exponent <= 22:
        return float(mantissa) / _EXACT[-exponent] if exponent < 0 else float(mantissa) * _EXACT[exponent]
    if exponent < -_EXPONENT or exponent > _EXPONENT:
        return np.nan
    shift = 0
    for step in (32, 16, 8, 4, 2, 1):
        if mantissa >> np.uint64(64 - step) == _U0:
            mantissa <<= np.uint64(step)
            shift += step
    product = _upper_half(mantissa, _TENS[exponent + _EXPONENT])
    drop = _U11 if product >= _TOP else _U10
    rest = product & ((_U1 << drop) - _U1)
    half = _U1 << (drop - _U1)
    kept = product >> drop
    if rest > half:
        kept += _U1
    elif rest + np.uint64(2 if whole else 40) > half:
        return np.nan
    return float(kept) * _LADDER[np.int64(drop) + 64 + _TWOS[exponent + _EXPONENT] - shift + _SCALE]


@numba.njit(nogil=True, cache=True)
def _number(data, at, end):  # type: ignore[no-untyped-def]
    """A number and where its token ends; NaN where Python must look."""
    negative = data[at] == 45
    if negative or data[at] == 43:
        at += 1
    mantissa, exponent, digits, whole, fraction = _U0, np.int64(0), 0, True, False
    while at < end:
        digit = data[at] - np.uint8(48)
        if digit <= 9:
            digits += 1
            if mantissa < _ROOM:
                mantissa = mantissa * _U10 + np.uint64(digit)
                exponent -= fraction
            else:
                whole = whole and digit == 0
                exponent += not fraction
        elif data[at] == 46 and not fraction:
            fraction = True
        else:
            break
        at += 1
    if digits and at + 1 < end and (data[at] | 32) == 101:
        at += 1
        down = data[at] == 45
        if down or data[at] == 43:
            at += 1
        power, found = np.int64(0), False
        while at < end and data[at] - np.uint8(48) <= 9 and power < 10_000:
            power = power * 10 + np.int64(data[at] - np.uint8(48))
            found = True
            at += 1
        exponent = exponent - power if down else exponent + power
        digits *= found
    clean = digits > 0
    while at < end and data[at] > 32:
        clean = clean and data[at] == 35
        at = end if data[at] == 35 else at + 1
    value = _scaled(mantissa, exponent, whole) if clean else np.nan
    return (-value if negative else value), at


@numba.njit(nogil=True, cache=True)
def split_lines(data, start, body, end, key):  # type: ignore[no-untyped-def]
    """Find the lines that hold something; returns how many.

    ``start`` and ``end`` bound a line without blanks before it, ``body`` follows its first word, and ``key`` packs
    that word's first eight characters, in lower case, or is 0 where it is longer.
    """
    count, at, size = 0, 0, len(data)
    while at < size:
        if data[at] <= 32:
            at += 1
            continue
        begin, word = at, _U0
        if data[at] != 35:
            while at < size and data[at] > 32:
                letter = np.uint64(data[at])
                if 65 <= data[at] <= 90:
                    letter |= _U32
                if at - begin < 8:
                    word |= letter << np.uint64(8 * (at - begin))
                at += 1
            start[count], body[count] = begin, at
            key[count] = word if at - begin <= 8 else _U0
        comment = data[begin] == 35
        while at < size and data[at] != 10 and data[at] != 13:
            at += 1
        if not comment:
            end[count] = at
            count += 1
    return count


@numba.njit(nogil=True, cache=True)
def parse_numbers(data, begin, end, slots, first, stop, values, starts, counts):  # type: ignore[no-untyped-def]
    """Numbers of the lines ``first`` to ``stop``, as many as ``slots`` leaves room for; all are counted.

    Line ``i`` fills ``values[slots[i]:slots[i + 1]]``; ``starts`` says where each number stands, or -1 where the line
    has none left.
    """
    for row in range(first, stop):
        at, last = begin[row], end[row]
        slot, count = slots[row], 0
        while at < last:
            if data[at] <= 32:
                at += 1
                continue
            if data[at] == 35:
                break
            count += 1
            if slot < slots[row + 1]:
                starts[slot] = at
                values[slot], at = _number(data, at, last)
                slot += 1
            else:
                while at < last and data[at] > 32 and data[at] != 35:
                    at += 1
        counts[row] = count
        for empty in range(slot, slots[row + 1]):
            values[empty], starts[empty] = 0.0, -1


@numba.njit(nogil=True, cache=True)
def parse_corners(data, begin, end, slots, first, stop, corners, normals):  # type: ignore[no-untyped-def]
    """Face corners of the form v, v/vt, v//vn or v/vt/vn; returns the offset of the first that is none, or -1.

    ``corners`` receives the three indices as they stand, 0 where one is missing; ``normals`` where the normal's
    index stands.
    """
    for row in range(first, stop):
        at = begin[row]
        for slot in range(slots[row], slots[row + 1]):
            while data[at] <= 32:
                at += 1
            corners[slot, 0], corners[slot, 1], corners[slot, 2] = 0, 0, 0
            token = at
            for part in range(3):
                sign, value, found = 1, np.int64(0), at
                if at < end[row] and data[at] == 45:
                    sign = -1
                    at += 1
                    found = at
                while at < end[row] and data[at] - np.uint8(48) <= 9:
                    value = value * 10 + np.int64(data[at] - np.uint8(48))
                    if value > 2_147_483_647:
                        return token
                    at += 1
                if (at > found and value == 0) or (at == found and (part == 0 or sign < 0)):
                    return token
                corners[slot, part] = sign * value
                if part == 2:
                    normals[slot] = found - (sign < 0)
                if at >= end[row] or data[at] != 47:
                    break
                at += 1
            if at < end[row] and data[at] > 32 and data[at] != 35:
                return token
    return -1


@numba.njit(nogil=True, cache=True)
def splice_tokens(data, starts, text, out):  # type: ignore[no-untyped-def]
    """Replace the tokens at ascending ``starts`` by the pieces of a comma-separated text; returns the length."""
    read, write, piece = 0, 0, 0
    for start in starts:
        for at in range(read, start):
            out[write] = data[at]
            write += 1
        read = start
        while read < len(data) and data[read] > 32 and data[read] not in (35, 44, 59, 92):
            read += 1  # a backslash, 92, continues the line; 44 and 59 are the separators of tables
        while piece < len(text) and text[piece] != 44:
            out[write] = text[piece]
            write += 1
            piece += 1
        piece += 1
    for at in range(read, len(data)):
        out[write] = data[at]
        write += 1
    return write
