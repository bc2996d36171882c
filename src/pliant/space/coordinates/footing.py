"""Coordinates of the closest point of a cage: what coordinates tend to on it, and what extends those of the inside."""

from __future__ import annotations

import numpy as np

from pliant.numerics.meshes.closest_surface import Closest
from pliant.space.coordinates.surface import CageSurface, Floats

_ZERO = 1e-12


def spread_out(surface: CageSurface, found: Closest) -> Floats:
    """(k, p) barycentric rows of closest points."""
    rows = np.zeros((len(found.points), len(surface.points)))
    np.put_along_axis(rows, surface.triangles[found.triangles], found.weights, axis=1)
    return rows


def foot_slopes(surface: CageSurface, found: Closest, moves: Floats) -> Floats:
    """(k, 3, 3) identity + the derivative of (p, 3) moves interpolated at the closest point.

    The closest point follows a step along the face that it is on, or along the edge; a vertex stays where it is.
    """
    corner_moves = moves[surface.triangles[found.triangles]]
    slopes = np.einsum("kca,kcb->kab", corner_moves, surface.gradients[found.triangles])
    used = found.weights > _ZERO
    slopes[used.sum(axis=1) == 1] = 0.0
    edge = np.flatnonzero(used.sum(axis=1) == 2)
    first = used[edge].argmax(axis=1)
    last = 2 - used[edge][:, ::-1].argmax(axis=1)
    corners = surface.corners[found.triangles[edge]]
    rows = np.arange(len(edge))
    line = corners[rows, last] - corners[rows, first]
    change = corner_moves[edge][rows, last] - corner_moves[edge][rows, first]
    slopes[edge] = change[:, :, None] * line[:, None] / (line**2).sum(axis=1)[:, None, None]
    return np.asarray(np.eye(3) + slopes)
