"""Which points lie inside a closed surface: how often a ray upwards from each crosses it.

Triangles are sorted into columns over a grid of the plane z = 0, so that a ray meets the triangles of one column only.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.compute.compiling import kernel

_SKEW = (1.7e-7, 1.1e-7)  # of the extent: rays avoid edges that lie straight above grid points


def inside(
    queries: NDArray[np.float64], points: NDArray[np.float64], triangles: NDArray[np.int32]
) -> NDArray[np.bool_]:
    """(q,) whether points are inside: an odd number of crossings. Where the surface is open, it means little."""
    result = np.zeros(len(queries), np.bool_)
    if not len(triangles) or not len(queries):
        return result
    low, high = points.min(axis=0), points.max(axis=0)
    extent = np.maximum(high - low, 1e-12 * max(float((high - low).max()), 1e-300))
    side = max(1, min(512, round(math.sqrt(len(triangles) / 2))))
    starts, owners = _columns(points, triangles, low, extent, side)
    shifted = queries + np.array([_SKEW[0] * extent[0], _SKEW[1] * extent[1], 0.0])

    def work(start, stop):
        _cross(shifted[start:stop], points, triangles, low, extent, side, starts, owners, result[start:stop])

    for_chunks(work, len(queries), 4096)
    return result


@kernel
def _columns(points, triangles, low, extent, side):
    """Triangles over each cell of the grid: starts and owners."""
    counts = np.zeros(side * side + 1, np.int64)
    boxes = np.empty((len(triangles), 4), np.int64)
    for t in range(len(triangles)):
        for axis in range(2):
            a, b, c = points[triangles[t, 0], axis], points[triangles[t, 1], axis], points[triangles[t, 2], axis]
            least, most = min(a, b, c), max(a, b, c)
            boxes[t, axis] = min(max(int((least - low[axis]) / extent[axis] * side), 0), side - 1)
            boxes[t, 2 + axis] = min(max(int((most - low[axis]) / extent[axis] * side), 0), side - 1)
        for i in range(boxes[t, 0], boxes[t, 2] + 1):
            for j in range(boxes[t, 1], boxes[t, 3] + 1):
                counts[i * side + j + 1] += 1
    starts = np.cumsum(counts)
    filled = starts[:-1].copy()
    owners = np.empty(starts[-1], np.int32)
    for t in range(len(triangles)):
        for i in range(boxes[t, 0], boxes[t, 2] + 1):
            for j in range(boxes[t, 1], boxes[t, 3] + 1):
                owners[filled[i * side + j]] = t
                filled[i * side + j] += 1
    return starts, owners


@kernel
def _cross(queries, points, triangles, low, extent, side, starts, owners, result):
    for q in range(len(queries)):
        x, y, z = queries[q, 0], queries[q, 1], queries[q, 2]
        u, v = (x - low[0]) / extent[0], (y - low[1]) / extent[1]
        if not (0 <= u < 1 and 0 <= v < 1):
            continue
        cell = int(u * side) * side + int(v * side)
        odd = False
        for entry in range(starts[cell], starts[cell + 1]):
            t = owners[entry]
            a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
            ax, ay = points[a, 0] - x, points[a, 1] - y
            bx, by = points[b, 0] - x, points[b, 1] - y
            cx, cy = points[c, 0] - x, points[c, 1] - y
            wa, wb, wc = bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx
            if (wa > 0 and wb > 0 and wc > 0) or (wa < 0 and wb < 0 and wc < 0):
                height = (wa * points[a, 2] + wb * points[b, 2] + wc * points[c, 2]) / (wa + wb + wc)
                odd ^= height > z
        result[q] = odd
