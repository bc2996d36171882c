"""What keeps polygons from being a closed, oriented 2-manifold: the edges and the vertices, by name."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.meshes.adjacency import half_edges
from pliant.numerics.ragged import Ragged

Indices = NDArray[np.int64]

_FLAT = 1e-12


@dataclass(frozen=True)
class Faults:
    """(k, 2) edges of one face only; (k, 2) of three or more, or of two that disagree; (k,) vertices of two fans."""

    open: Indices
    wrong: Indices
    pinched: Indices

    @property
    def none(self) -> bool:
        """Whether the polygons are a closed, oriented manifold."""
        return not (len(self.open) or len(self.wrong) or len(self.pinched))


def manifold_faults(polygons: Ragged, count: int) -> Faults:
    """The faults of polygons on ``count`` vertices."""
    half = half_edges(polygons)
    edges, inverse, uses = np.unique(np.sort(half, axis=1), axis=0, return_inverse=True, return_counts=True)
    forward = np.bincount(inverse.reshape(-1), weights=half[:, 0] < half[:, 1], minlength=len(edges))
    loops = edges[:, 0] == edges[:, 1] if len(edges) else np.zeros(0, bool)
    wrong = (uses > 2) | ((uses == 2) & (forward != 1)) | loops
    return Faults(edges[(uses == 1) & ~loops], edges[wrong], _pinched(polygons, count))


def flat_triangles(points: NDArray[np.float64], triangles: NDArray[np.integer]) -> Indices:
    """(k,) triangles whose area is nothing beside the square of the whole's diagonal."""
    corners = points[triangles]
    double = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    square = float((np.ptp(points, axis=0) ** 2).sum()) if len(points) else 0.0
    return np.flatnonzero(double <= 2 * _FLAT * square)


def pieces(edges: Indices, count: int) -> tuple[int, Indices]:
    """How many connected pieces (e, 2) edges make of ``count`` vertices, and the piece of each."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    links = coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count))
    number, labels = connected_components(links, directed=False)
    return int(number), labels.astype(np.int64)


def _pinched(polygons: Ragged, count: int) -> Indices:
    """Vertices whose corners do not hang together by edges."""
    corners = np.arange(len(polygons.flat))
    previous = np.empty(len(corners), np.int64)
    following = np.empty(len(corners), np.int64)
    starts, lengths = polygons.offsets[:-1], polygons.lengths
    row = polygons.row_of
    place = corners - starts[row]
    following[:] = starts[row] + (place + 1) % lengths[row]
    previous[:] = starts[row] + (place - 1) % lengths[row]
    here, there, back = polygons.flat, polygons.flat[following], polygons.flat[previous]
    keys = np.concatenate([np.stack([here, there], axis=1), np.stack([here, back], axis=1)])
    owner = np.concatenate([corners, corners])
    _, group = np.unique(keys, axis=0, return_inverse=True)
    group = group.reshape(-1)
    total = len(corners)
    number, labels = pieces(np.stack([owner, total + group], axis=1), total + (int(group.max()) + 1 if total else 0))
    fans = np.unique(np.stack([polygons.flat, labels[:total]], axis=1), axis=0)
    return np.flatnonzero(np.bincount(fans[:, 0], minlength=count) > 1) if number else np.empty(0, np.int64)
