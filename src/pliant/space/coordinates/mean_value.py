"""Mean value coordinates (Ju, Schaefer & Warren 2005): closed form, smooth, defined in all of space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.coordinates import mean_value
from pliant.space.coordinates.base import Coordinates
from pliant.space.coordinates.footing import spread_out
from pliant.space.coordinates.surface import Floats

_STEP = 1e-7  # of the cage's diagonal: where a derivative is taken for a point on the cage, which has two


class MeanValue(Coordinates):
    """Mean value coordinates of triangles, in the form of mean vectors.

    They reproduce affine maps everywhere. Inside convex cages they are positive; in the hollows of others some are
    slightly negative, so that a point may move against a vertex that it does not see. Outside the cage the same
    formula holds, and the interpolation is continuous across it.
    """

    def rows(self, points: Floats) -> tuple[Floats, Floats | None, NDArray[np.int8]]:
        surface = self.surface
        out, place = np.empty((len(points), len(surface.points))), np.empty(len(points), np.int8)
        mean_value.mean_value_weights(
            points.reshape(-1),
            0,
            len(points),
            surface.points.reshape(-1),
            surface.edges,
            surface.lines,
            surface.triangles,
            surface.sides,
            surface.duals,
            out,
            place,
        )
        touching = np.flatnonzero(place == 0)
        if len(touching):
            out[touching] = spread_out(surface, surface.closest(points[touching]))
        return (out if self.prolongation is None else np.asarray(out @ self.prolongation)), None, place

    def slopes(self, points: Floats, moves: Floats, pulls: Floats | None) -> Floats:
        surface = self.surface
        place = self.rows(points)[2]
        points = points.copy()
        touching = np.flatnonzero(place == 0)
        if len(touching):
            found = surface.closest(points[touching])
            normals = surface.planes[found.triangles, :3]
            points[touching] = found.points - _STEP * normals
        out = np.empty(9 * len(points))
        mean_value.mean_value_jacobians(
            points.reshape(-1),
            0,
            len(points),
            surface.points.reshape(-1),
            surface.edges,
            surface.lines,
            surface.triangles,
            surface.sides,
            surface.normals.reshape(-1),
            np.ascontiguousarray(self.prolonged(moves)).reshape(-1),
            out,
        )
        return out.reshape(-1, 3, 3)
