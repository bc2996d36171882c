"""Tetrahedral meshes: their surface, and which tetrahedron a point lies in."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Cells = NDArray[np.int32]

_NEAR, _MOST = 16, 1024  # tetrahedra, by their centres, that a point is sought in at first, and at last
_SIDES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def boundary(points: Floats, cells: Cells) -> Cells:
    """(t, 3) the sides that belong to one tetrahedron of (m, 4) alone, each seen counter-clockwise from outside."""
    corners = points[cells]
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1])
    turned = np.where(volume[:, None] < 0, cells[:, [0, 2, 1, 3]], cells)
    sides = turned[:, _SIDES].reshape(-1, 3)
    _, first, count = np.unique(np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True)
    return np.asarray(sides[np.sort(first[count == 1])], np.int32)


def surrounding(points: Floats, cells: Cells, queries: Floats) -> tuple[Cells, Floats]:
    """(m, 4) the corners of the tetrahedron that each query lies in, or is least outside of, and (m, 4) weights there.

    Outside of all, weights below zero count as zero: the query follows the nearest side or corner.
    """
    from scipy.spatial import cKDTree

    corners = points[cells]
    edges = np.transpose(corners[:, 1:] - corners[:, :1], (0, 2, 1))
    flat = np.abs(np.linalg.det(edges)) <= 1e-14 * np.abs(edges).max(axis=(1, 2)) ** 3
    usable = np.flatnonzero(~flat)
    tree, inverse = cKDTree(corners[usable].mean(axis=1)), np.linalg.inv(edges[usable])
    chosen, weights = np.empty((len(queries), 4), np.int32), np.empty((len(queries), 4))
    left, count = np.arange(len(queries)), min(_NEAR, len(usable))
    while len(left):
        near = tree.query(queries[left], k=count)[1].reshape(len(left), -1)
        away = queries[left, None] - corners[usable[near], 0]
        inner = np.einsum("mkij,mkj->mki", inverse[near], away)
        all_four = np.concatenate([1 - inner.sum(axis=2, keepdims=True), inner], axis=2)
        best = all_four.min(axis=2).argmax(axis=1)
        rows = np.arange(len(left))
        chosen[left], weights[left] = cells[usable[near[rows, best]]], all_four[rows, best]
        if count in (len(usable), _MOST):
            break
        left = left[weights[left].min(axis=1) < -1e-9]
        count = min(8 * count, len(usable), _MOST)
    weights = np.maximum(weights, 0.0)
    return chosen, np.asarray(weights / weights.sum(axis=1, keepdims=True))
