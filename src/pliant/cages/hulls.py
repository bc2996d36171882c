"""The convex hull of a limb's end: what a cage goes along where fingers, claws and hooves are of no interest."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.cages.parting import finer, traced
from pliant.cages.sections import Cut, half_edges_of
from pliant.mesh import Points

Indices = NDArray[np.int64]
Surface = tuple[Points, Indices, Indices]

_ENOUGH = 2000  # triangles
_BESIDE = 0.05  # of the room: how far behind its plane an end may reach


def end_hull(ring: Points, region: Points, cut: Cut, below: bool, room: float) -> Surface | None:
    """The convex hull of a ring and the region beyond it, open at the ring.

    Returns
    -------
    points, triangles
        The hull, cut fine.
    rim
        The vertices on the ring, in order, counter-clockwise about the plane's normal.
    None, where the region reaches behind the plane, so that the ring is no side of its hull.
    """
    from scipy.spatial import ConvexHull

    depth = (region - cut.origin) @ (cut.normal if not below else -cut.normal)
    if depth.min() < -_BESIDE * room or depth.max() < room:
        return None
    every = np.concatenate([ring, region[depth > _BESIDE * room]])
    hull = ConvexHull(every)
    corners = every[hull.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inwards = np.einsum("ti,ti->t", normals, hull.equations[:, :3]) < 0
    triangles = np.where(inwards[:, None], hull.simplices[:, ::-1], hull.simplices).astype(np.int64)
    triangles = triangles[(triangles >= len(ring)).any(axis=1)]
    points, triangles = finer(every, triangles, _ENOUGH)
    half = half_edges_of(triangles)
    known = half[:, 0] * len(points) + half[:, 1]
    steps = half[~np.isin(half[:, 1] * len(points) + half[:, 0], known)]
    if not len(steps) or len(rim := traced(steps)) != len(steps):
        return None
    return points, triangles, rim[::-1] if below else rim
