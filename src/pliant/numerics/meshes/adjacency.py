"""Who touches whom in a set of polygons."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.ragged import Ragged

Pairs = NDArray[np.int32]


def half_edges(polygons: Ragged) -> Pairs:
    """(c, 2) for each corner its vertex and the next one of its polygon."""
    following = np.roll(polygons.flat, -1)
    filled = polygons.lengths > 0
    following[polygons.offsets[1:][filled] - 1] = polygons.flat[polygons.offsets[:-1][filled]]
    return np.stack([polygons.flat, following], axis=1)


def unique_edges(polygons: Ragged) -> Pairs:
    """(e, 2) each edge once, the lower vertex first, sorted; without those from a vertex to itself."""
    both = np.sort(half_edges(polygons), axis=1)
    return np.unique(both[both[:, 0] != both[:, 1]], axis=0)


def neighbors(edges: Pairs, count: int) -> Ragged:
    """For each of ``count`` vertices the sorted vertices that it shares one of (e, 2) edges with."""
    both = np.vstack([edges, edges[:, ::-1]])
    both = both[np.lexsort((both[:, 1], both[:, 0]))]
    counts = np.bincount(both[:, 0], minlength=count)
    return Ragged(both[:, 1], np.concatenate([[0], np.cumsum(counts)]))


def edge_use(polygons: Ragged) -> tuple[int, int]:
    """How many edges bound one polygon only, and how many bound three or more, or two that disagree."""
    half = half_edges(polygons)
    half = half[half[:, 0] != half[:, 1]]
    _, inverse, count = np.unique(np.sort(half, axis=1), axis=0, return_inverse=True, return_counts=True)
    forward = np.bincount(inverse.reshape(-1), weights=half[:, 0] < half[:, 1], minlength=len(count))
    wrong = (count > 2) | ((count == 2) & (forward != 1))
    return int((count == 1).sum()), int(wrong.sum())
