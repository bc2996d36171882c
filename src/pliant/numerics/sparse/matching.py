"""A kernel that halves a graph: neighbours become pairs (heavy-edge matching, Karypis & Kumar 1998)."""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel
from pliant.numerics.compute.lanes import get


@kernel
def halve(pointers, indices, values):
    """Pair each unknown of a sparse symmetric matrix with the free neighbour of its largest entry.

    Returns
    -------
    members
        (p, 2) the unknowns of each pair; -1 as the second of one that is left alone.
    starts, neighbors
        The graph of the pairs, without loops: the neighbours of pair c are ``neighbors[starts[c] : starts[c + 1]]``.
    """
    members, pair = _match(pointers, indices, values)
    count = len(members)
    starts, neighbors = np.empty(count + 1, np.int32), np.empty(len(indices), np.int32)
    seen, end = np.empty(count, np.int64), 0
    for c in range(count):
        seen[c] = -1
    for c in range(count):
        seen[c], starts[c] = c, end
        for side in range(2):
            i = members[c, side]
            for p in range(pointers[i], pointers[i + 1] if i >= 0 else pointers[i]):
                other = get(pair, get(indices, p))
                if seen[other] != c:
                    seen[other], neighbors[end] = c, other
                    end += 1
    starts[count] = end
    return members, starts, neighbors[:end]


@inlined
def _match(pointers, indices, values):
    size, count = len(pointers) - 1, 0
    pair, members = np.empty(size, np.int64), np.empty((size, 2), np.int64)
    for i in range(size):
        pair[i] = -1
    for i in range(size):
        if pair[i] >= 0:
            continue
        mate, most = -1, -1.0
        for p in range(pointers[i], pointers[i + 1]):
            j, value = get(indices, p), abs(get(values, p))
            if value > most and j != i and get(pair, j) < 0:
                mate, most = j, value
        members[count, 0], members[count, 1] = i, mate
        pair[i] = count
        if mate >= 0:
            pair[mate] = count
        count += 1
    return members[:count], pair
