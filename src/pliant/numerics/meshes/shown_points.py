"""Points and normals in as few bits as a screen shows: what travels to a page while somebody drags."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.compute.compiling import inlined, kernel

_SMALL = 1e-300


def corners_at(triangles: NDArray[np.int32], count: int) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """For each of ``count`` vertices the triangles around it: (count + 1,) starts and (3 t,) triangles."""
    flat = triangles.reshape(-1)
    starts = np.zeros(count + 1, np.int64)
    np.cumsum(np.bincount(flat, minlength=count), out=starts[1:])
    return starts, (np.argsort(flat, kind="stable") // 3).astype(np.int32)


@inlined
def _pack(out, row, x, y, z, factor):
    out[row, 0] = np.int8(math.floor(factor * x + 0.5))
    out[row, 1] = np.int8(math.floor(factor * y + 0.5))
    out[row, 2] = np.int8(math.floor(factor * z + 0.5))


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
            _pack(out, row, nx, ny, nz, 127.0 / length)
    return out


@kernel
def packed_normals(sums, chosen):
    """(k, 3) some of (n, 3) vectors as unit normals, likewise."""
    out = np.zeros((len(chosen), 3), np.int8)
    for row in range(len(chosen)):
        x, y, z = sums[chosen[row], 0], sums[chosen[row], 1], sums[chosen[row], 2]
        length = math.sqrt(x * x + y * y + z * z)
        if length > _SMALL:
            _pack(out, row, x, y, z, 127.0 / length)
    return out


@inlined
def _steps(low, high):
    return 65535 / (high - low) if high > low else 0.0


@kernel
def shown_points(points, chosen):
    """(k, 3) some points as uint16 in their bounding box, and its corners: a step is a 65535th of its extent."""
    low_x = low_y = low_z = np.inf
    high_x = high_y = high_z = -np.inf
    for row in range(len(chosen)):
        x, y, z = points[chosen[row], 0], points[chosen[row], 1], points[chosen[row], 2]
        low_x, low_y, low_z = min(low_x, x), min(low_y, y), min(low_z, z)
        high_x, high_y, high_z = max(high_x, x), max(high_y, y), max(high_z, z)
    along_x, along_y, along_z = _steps(low_x, high_x), _steps(low_y, high_y), _steps(low_z, high_z)
    out = np.empty((len(chosen), 3), np.uint16)
    for row in range(len(chosen)):
        vertex = chosen[row]
        out[row, 0] = np.uint16((points[vertex, 0] - low_x) * along_x + 0.5)
        out[row, 1] = np.uint16((points[vertex, 1] - low_y) * along_y + 0.5)
        out[row, 2] = np.uint16((points[vertex, 2] - low_z) * along_z + 0.5)
    return out, np.array([low_x, low_y, low_z]), np.array([high_x, high_y, high_z])
