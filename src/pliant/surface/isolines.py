"""Isolines of a scalar on a triangle mesh: which edges each crosses, and which crossings make one loop."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Isolines:
    """Loops of isolines, numbered by ascending level.

    Parameters
    ----------
    level
        (g,) which of the levels each loop belongs to.
    closed
        (g,) whether it is; a loop that ends at the mesh's boundary is not.
    edges, loops
        (k, 2) the crossed edges, and (k,) the loop that crosses each.
    """

    level: Integers
    closed: NDArray[np.bool_]
    edges: NDArray[np.int32]
    loops: Integers


def isolines(triangles: NDArray[np.int32], scalar: Floats, levels: Floats) -> Isolines:
    """Cut a scalar (n,) at levels (m,).

    A vertex exactly at a level counts as above it, so that an isoline crosses two edges of a triangle, or none. The
    two crossings follow each other on one loop; so a level that crosses two legs gives two loops.
    """
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, number = np.unique(sides, axis=0, return_inverse=True)
    number = number.reshape(-1, 3)
    values = scalar[edges]
    low, high = values.min(axis=1), values.max(axis=1)
    level_of, closed, crossed, loop_of, count = [], [], [], [], 0
    for at, level in enumerate(levels):
        cut = (low < level) & (high >= level)
        places = np.flatnonzero(cut)
        if not len(places):
            continue
        place_of = np.cumsum(cut) - 1
        inside = cut[number]
        through = inside.sum(axis=1) == 2
        pairs = place_of[number[through][inside[through]].reshape(-1, 2)]
        graph = csr_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(places), len(places)))
        found, label = connected_components(graph, directed=False)
        ends = np.bincount(pairs.reshape(-1), minlength=len(places)) < 2
        level_of.append(np.full(found, at))
        closed.append(np.bincount(label, weights=ends, minlength=found) == 0)
        crossed.append(edges[places])
        loop_of.append(count + label)
        count += found
    if not count:
        none = np.empty(0, np.int64)
        return Isolines(none, np.empty(0, bool), np.empty((0, 2), np.int32), none)
    return Isolines(
        np.concatenate(level_of),
        np.concatenate(closed),
        np.concatenate(crossed),
        np.concatenate(loop_of).astype(np.int64),
    )
