"""A cage cut finer, its faces kept as they are: triangles flat, quadrangles as bilinear patches."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, eye_array, vstack

Indices = NDArray[np.int64]


def refined(count: int, triangles: Indices, quads: Indices, levels: int) -> tuple[csr_array, Indices]:
    """Triangles of faces that are cut into four, ``levels`` times.

    In the end quadrangles become four triangles around their middle, (a + b + c + d) / 4: no diagonal is preferred.

    Parameters
    ----------
    count
        Number m of vertices.
    triangles, quads
        (t, 3) and (q, 4) vertices.
    levels
        How often.

    Returns
    -------
    prolongation
        (p, m) how the vertices of the finer triangles follow from the m.
    triangles
        (4^levels (t + 4 q), 3).
    """
    rows = csr_array(eye_array(count))
    for _ in range(levels):
        rows, triangles, quads = _halved(rows, triangles, quads)
    middles = rows.shape[0] + np.arange(len(quads))
    rows = _added(rows, quads)
    fans = [np.stack([quads[:, i], quads[:, (i + 1) % 4], middles], axis=1) for i in range(4)]
    return rows, np.concatenate([triangles, *fans])


def _halved(rows: csr_array, triangles: Indices, quads: Indices) -> tuple[csr_array, Indices, Indices]:
    sides = [np.stack([face, np.roll(face, -1, axis=1)], axis=2).reshape(-1, 2) for face in (triangles, quads)]
    edges, place = np.unique(np.sort(np.concatenate(sides), axis=1), axis=0, return_inverse=True)
    middles = rows.shape[0] + place.reshape(-1)
    a = middles[: triangles.size].reshape(-1, 3)
    b = middles[triangles.size :].reshape(-1, 4)
    center = rows.shape[0] + len(edges) + np.arange(len(quads))
    rows = csr_array(vstack([_added(rows, edges), _means(rows, quads)]))
    corner = [np.stack([triangles[:, i], a[:, i], a[:, (i + 2) % 3]], axis=1) for i in range(3)]
    patch = [np.stack([quads[:, i], b[:, i], center, b[:, (i + 3) % 4]], axis=1) for i in range(4)]
    return rows, np.concatenate([*corner, a]), np.concatenate(patch)


def _added(rows: csr_array, groups: Indices) -> csr_array:
    return csr_array(vstack([rows, _means(rows, groups)]))


def _means(rows: csr_array, groups: Indices) -> csr_array:
    """The mean of the rows of each group."""
    size = groups.shape[1]
    starts = np.arange(0, groups.size + 1, size)
    pick = csr_array((np.full(groups.size, 1 / size), groups.reshape(-1), starts), (len(groups), rows.shape[0]))
    return csr_array(pick @ rows)
