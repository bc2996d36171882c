"""Triangles of a cage joined in pairs to quadrangles: what is between two rings shall look like it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.cages.rings import Ring
from pliant.mesh import Points

Indices = NDArray[np.int64]

_LEVEL = 0.6  # the least cosine between the two triangles of a quadrangle
_SKEW = 0.8  # the largest cosine of its angles, or of their opposites


def with_quads(points: Points, triangles: Indices, rings: list[Indices]) -> list[Ring]:
    """The faces of a cage: quadrangles where two triangles make a good one, the best first; rings stay edges."""
    half = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    place = {(a, b): at for at, (a, b) in enumerate(half.tolist())}
    kept = {(int(a), int(b)) for ring in rings for a, b in zip(ring, np.roll(ring, -1), strict=True)}
    first, second, third = points[triangles].transpose(1, 0, 2)
    normals = np.cross(second - first, third - first)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    inner = np.array([[at, place[b, a]] for (a, b), at in place.items() if a < b and not {(a, b), (b, a)} & kept])
    if not len(inner):
        return list(triangles.tolist())
    one, two = inner.T // 3
    beyond = triangles.reshape(-1)[3 * (inner // 3) + (inner % 3 + 2) % 3]
    (a, b), (c, d) = half[inner[:, 0]].T, beyond.T
    polygons = np.stack([a, d, b, c], axis=1)  # whose fan are these two triangles
    corners = points[polygons]
    ways = np.roll(corners, -1, axis=1) - corners
    ways /= np.maximum(np.linalg.norm(ways, axis=2, keepdims=True), 1e-300)
    skew = np.abs(np.einsum("qki,qki->qk", ways, np.roll(ways, 1, axis=1))).max(axis=1)
    middle = (normals[one] + normals[two])[:, None]
    turns = np.einsum("qki,qki->qk", np.cross(np.roll(ways, 1, axis=1), ways), np.broadcast_to(middle, ways.shape))
    level = np.einsum("qi,qi->q", normals[one], normals[two])
    good = (level > _LEVEL) & (skew < _SKEW) & (turns > 0).all(axis=1) & (c != d)
    free, faces = np.ones(len(triangles), bool), list[Ring]()
    for at in np.argsort(skew - level, kind="stable"):
        if good[at] and free[one[at]] and free[two[at]]:
            free[[one[at], two[at]]] = False
            faces.append(polygons[at].tolist())
    return [*faces, *triangles[free].tolist()]
