"""Finding the values of PLY elements whose lists differ in length."""

from __future__ import annotations

import numba
import numpy as np


@numba.njit(nogil=True, cache=True)
def walk_lists(data, begin, rows, sizes, counts, kinds, little, places, lengths):  # type: ignore[no-untyped-def]
    """Find the properties of elements that hold lists; returns where they end, or -1 - row where the data does.

    Per property: ``sizes`` of an item, ``counts`` the size of the count or 0 where it is no list, ``kinds`` 1 for
    counts that are signed and 2 for such as are float64. ``places`` receives each property's first byte, ``lengths``
    the length of its list.
    """
    at = np.int64(begin)
    number = np.empty(1, np.float64)
    raw = number.view(np.uint8)
    for row in range(rows):
        for column in range(len(sizes)):
            places[row, column] = at
            length, width = np.int64(1), counts[column]
            if width:
                if at + width > len(data):
                    return -1 - row
                if kinds[column] == 2:
                    for byte in range(8):
                        raw[byte] = data[at + byte]
                    length = np.int64(number[0] if 0 <= number[0] < 2**31 and number[0] % 1 == 0 else -1)
                else:
                    length = np.int64(0)
                    for byte in range(width):
                        shift = byte if little else width - 1 - byte
                        length |= np.int64(data[at + byte]) << (8 * shift)
                    if kinds[column] == 1 and length >> (8 * width - 1):
                        length = np.int64(-1)
                if length < 0:
                    return -1 - row
                at += width
            lengths[row, column] = length
            at += length * sizes[column]
            if at > len(data):
                return -1 - row
    return at
