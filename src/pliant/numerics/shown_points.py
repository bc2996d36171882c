"""Points and normals in as few bits as a screen shows: what travels to a page while somebody drags."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.compiling import kernel

_SMALL = 1e-300


def corners_at(triangles: NDArray[np.int32], count: int) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """For each of ``count`` vertices the triangles around it: (count + 1,) starts and (3 t,) triangles."""
    flat = triangles.reshape(-1)
    starts = np.zeros(count + 1, np.int64)
    np.cumsum(np.bincount(flat, minlength=count), out=starts[1:])
    return starts, (np.argsort(flat, kind="stable") // 3).astype(np.int32)


@kernel
def shown_normals(points, chosen, triangles, starts, around):
    """(k, 3) unit normals at some vertices, weighted by area, as int8: 127 is one."""
    out = np.zeros((len(chosen), 3), np.int8)
    for row in range(len(chosen)):
        vertex = chosen[row]
        nx, ny, nz = 0.0, 0.0, 0.0
        for entry in range(starts[vertex], starts[vertex + 1]):
            triangle = around[entry]
            a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
            x, y, z = points[a, 0], points[a, 1], points[a, 2]
            ux, uy, uz = points[b, 0] - x, points[b, 1] - y, points[b, 2] - z
            vx, vy, vz = points[c, 0] - x, points[c, 1] - y, points[c, 2] - z
            nx += uy * vz - uz * vy
            ny += uz * vx - ux * vz
            nz += ux * vy - uy * vx
        length = math.sqrt(nx * nx + ny * ny + nz * nz)
        if length > _SMALL:
            out[row, 0] = np.int8(round(127 * nx / length))
            out[row, 1] = np.int8(round(127 * ny / length))
            out[row, 2] = np.int8(round(127 * nz / length))
    return out


@kernel
def shown_points(points, chosen):
    """(k, 3) some points as uint16 in their bounding box, and its corners: a step is a 65535th of its extent."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for row in range(len(chosen)):
        for axis in range(3):
            value = points[chosen[row], axis]
            low[axis] = min(low[axis], value)
            high[axis] = max(high[axis], value)
    out = np.zeros((len(chosen), 3), np.uint16)
    for axis in range(3):
        extent = high[axis] - low[axis]
        factor = 65535 / extent if extent > 0 else 0.0
        for row in range(len(chosen)):
            out[row, axis] = np.uint16((points[chosen[row], axis] - low[axis]) * factor + 0.5)
    return out, low, high
