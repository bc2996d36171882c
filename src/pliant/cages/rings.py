"""Rings of a cage: polygons around sections, and how rings are linked: tubes, branches, caps."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.cages.sections import Cut, axes_across
from pliant.mesh import Points

Floats = NDArray[np.float64]
Ring = list[int]
"""Indices of a ring's vertices, counter-clockwise seen from outside the region that it bounds."""


def reach_of(points: Points, cut: Cut, sides: int = 12) -> Floats:
    """(sides,) how far points go from a cut's origin, in evenly spaced directions across its normal."""
    first, second = axes_across(cut.normal)
    angles = 2 * np.pi * np.arange(sides) / sides
    directions = np.outer(np.cos(angles), first) + np.outer(np.sin(angles), second)
    return np.asarray(((points - cut.origin) @ directions.T).max(axis=0))


def polygon_around(points: Points, cut: Cut, sides: int, margin: float) -> Points:
    """(sides, 3) the convex polygon in a cut's plane whose sides touch the projected points, at a distance.

    Its sides look in evenly spaced directions; it is counter-clockwise about the cut's normal.
    """
    first, second = axes_across(cut.normal)
    angles = 2 * np.pi * np.arange(sides) / sides
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    reach = reach_of(points, cut, sides) + margin
    following = np.roll(directions, -1, axis=0)
    corners = np.linalg.solve(
        np.stack([directions, following], axis=1), np.stack([reach, np.roll(reach, -1)], 1)[..., None]
    )
    corners = corners[..., 0]
    return np.asarray(cut.origin + corners[:, :1] * first + corners[:, 1:] * second)


def tube(points: Points, one: Ring, two: Ring) -> list[Ring]:
    """Quadrangles between the two rings of a region, linked where they are nearest."""
    turned = one[::-1]
    costs = [((points[np.roll(turned, -shift)] - points[two]) ** 2).sum() for shift in range(len(turned))]
    turned = np.roll(turned, -int(np.argmin(costs))).tolist()
    after = [*range(1, len(two)), 0]
    return [[turned[i], turned[j], two[j], two[i]] for i, j in enumerate(after)]


def branch(points: Points, rings: list[Ring]) -> list[Ring] | None:
    """Triangles between three rings or more: their convex hull, without the rings themselves.

    None where a ring lies inside the hull of the others, so that it bounds no side of it.
    """
    from scipy.spatial import ConvexHull

    used = np.concatenate([np.array(ring) for ring in rings])
    owner = np.repeat(np.arange(len(rings)), [len(ring) for ring in rings])
    hull = ConvexHull(points[used])
    corners = points[used][hull.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inwards = np.einsum("ti,ti->t", normals, hull.equations[:, :3]) < 0
    triangles = np.where(inwards[:, None], hull.simplices[:, ::-1], hull.simplices)
    between = ~(owner[triangles] == owner[triangles[:, :1]]).all(axis=1)
    faces = used[triangles[between]]
    half = {(int(a), int(b)) for face in faces for a, b in zip(face, np.roll(face, -1), strict=True)}
    border = {(a, b) for a, b in half if (b, a) not in half}
    wanted = {(b, a) for ring in rings for a, b in zip(ring, ring[1:] + ring[:1], strict=True)}
    return [face.tolist() for face in faces] if wanted <= border else None


def cap(ring: Ring, region: Points, cut: Cut, outwards: Floats, margin: float) -> Points:
    """(sides, 3) a second ring: around the far half of the region that a single ring bounds, beyond its end."""
    depth = (cut.origin - region) @ outwards
    deepest = float(depth.max(initial=0.0))
    far = region[depth >= 0.5 * deepest]
    last = Cut(cut.origin - (deepest + margin) * outwards, cut.normal)
    return polygon_around(far, last, len(ring), margin)
