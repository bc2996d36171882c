"""Loop's subdivision of triangles (Loop 1987, "Smooth subdivision surfaces based on triangles")."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, eye_array, vstack

Triangles = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Subdivision:
    """Finer triangles, and how their vertices follow from the coarse ones.

    Parameters
    ----------
    triangles
        (4^l f, 3); the pieces of a coarse triangle stand together. The coarse vertices keep their numbers.
    weights
        (m, n) from coarse vertices to fine ones; rows sum to one.
    """

    triangles: Triangles
    weights: csr_array

    @classmethod
    def of(cls, triangles: Triangles, count: int, levels: int = 1) -> Self:
        """Each triangle cut into four, ``levels`` times: a manifold of ``count`` vertices, with or without bounds."""
        result = cls(np.asarray(triangles, np.int32), csr_array(eye_array(count)))
        for _ in range(levels):
            finer, weights = _split(result.triangles, result.weights.shape[0])
            result = cls(finer, csr_array(weights @ result.weights))
        return result


def _split(triangles: Triangles, count: int) -> tuple[Triangles, csr_array]:
    corners = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges, of_corner, uses = np.unique(np.sort(corners, axis=1), axis=0, return_inverse=True, return_counts=True)
    of_corner = of_corner.reshape(-1)
    a, b, c = triangles.T
    ab, bc, ca = (count + of_corner.reshape(-1, 3)).T
    pieces = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    finer = np.stack([np.stack(piece, axis=-1) for piece in pieces], axis=1).reshape(-1, 3)
    facing = np.roll(triangles, 1, axis=1).reshape(-1)  # the vertex across from each corner's edge
    inner = uses == 2
    across = inner[of_corner]
    ends = np.where(inner, 3 / 8, 1 / 2)
    e = np.arange(len(edges))
    new = coo_array(
        (
            np.concatenate([ends, ends, np.full(int(across.sum()), 1 / 8)]),
            (np.concatenate([e, e, of_corner[across]]), np.concatenate([edges[:, 0], edges[:, 1], facing[across]])),
        ),
        shape=(len(edges), count),
    )
    rows = csr_array(_old(edges, inner, count)), csr_array(new)
    return finer.astype(np.int32), csr_array(vstack(rows))


def _old(edges: NDArray[np.integer], inner: NDArray[np.bool_], count: int) -> csr_array:
    """(n, n) how coarse vertices move: inside by Loop's weights, on the border as a cubic B-spline does."""
    border = np.zeros(count, bool)
    border[edges[~inner]] = True
    valence = np.bincount(edges.ravel(), minlength=count)
    valence = np.maximum(valence, 1)
    beta = (5 / 8 - (3 / 8 + np.cos(2 * np.pi / valence) / 4) ** 2) / valence
    both = np.vstack([edges, edges[:, ::-1]])
    on_border = np.concatenate([~inner, ~inner])
    to, of = both[~border[both[:, 0]] | on_border].T
    values = np.where(border[to], 1 / 8, beta[to])
    own = np.where(border, 3 / 4, 1 - valence * beta)
    diagonal = np.arange(count)
    return csr_array(
        coo_array(
            (np.concatenate([values, own]), (np.concatenate([to, diagonal]), np.concatenate([of, diagonal]))),
            shape=(count, count),
        )
    )
