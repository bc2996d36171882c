"""Winding numbers of closed triangle surfaces: 1 inside, 0 outside (van Oosterom & Strackee 1983)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.compute.chunks import for_chunks

Floats = NDArray[np.float64]


def winding_numbers(queries: Floats, points: Floats, triangles: NDArray[np.integer]) -> Floats:
    """(k,) how often the surface goes around each of (k, 3) queries."""
    from pliant.numerics.coordinates.solid_angles import solid_angles

    flat, vertices = np.ascontiguousarray(queries).reshape(-1), np.ascontiguousarray(points).reshape(-1)
    corners, result = np.ascontiguousarray(triangles, np.int64), np.empty(len(queries))
    for_chunks(lambda first, stop: solid_angles(flat, first, stop, vertices, corners, result), len(queries), 1024)
    return result / (4 * np.pi)


def signed_volume(points: Floats, triangles: NDArray[np.integer]) -> float:
    """The volume that triangles enclose; negative where they are inside out."""
    if not len(triangles):
        return 0.0
    a, b, c = (points[triangles[:, i]] - points.mean(axis=0) for i in range(3))
    return float(np.einsum("ti,ti->", a, np.cross(b, c)) / 6)
