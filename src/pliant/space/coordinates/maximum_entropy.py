"""Maximum entropy coordinates (Hormann & Sukumar 2008): never negative, also in cages with hollows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from pliant.errors import NotConverged
from pliant.numerics.coordinates import maximum_entropy
from pliant.space.coordinates.base import Coordinates
from pliant.space.coordinates.footing import foot_slopes, spread_out
from pliant.space.coordinates.mean_value import MeanValue
from pliant.space.coordinates.surface import CageSurface, Floats

_NEAR = 1e-7  # of the cage's diagonal: nearer to it, priors are rounding noise and the closest point's row is used
_MISSED = 1e-9


class MaximumEntropy(Coordinates):
    """Maximum entropy coordinates with priors that vanish on the triangles that a vertex is not part of.

    They are zero or more, add up to one and reproduce affine maps. Outside, a point follows the closest point of the
    cage.
    """

    bounded = True

    def __init__(self, surface: CageSurface, prolongation: csr_array | None = None) -> None:
        super().__init__(surface, prolongation)
        self._sign = MeanValue(surface)

    def rows(self, points: Floats) -> tuple[Floats, Floats | None, NDArray[np.int8]]:
        surface, place = self.surface, self._place(points)
        out = np.empty((len(points), len(surface.points)))
        inside = np.flatnonzero(place > 0)
        found, missed = np.empty((len(inside), len(surface.points))), np.empty(len(inside))
        held = np.ascontiguousarray(points[inside]).reshape(-1)
        maximum_entropy.entropy_weights(held, 0, len(inside), *self._shape, found, missed)
        _require_solved(missed)
        out[inside] = found
        beyond = np.flatnonzero(place <= 0)
        if len(beyond):
            out[beyond] = spread_out(surface, surface.closest(points[beyond]))
        return out, None, place

    def slopes(self, points: Floats, moves: Floats, pulls: Floats | None) -> Floats:
        place = self._place(points)
        result = np.empty((len(points), 3, 3))
        inside, beyond = np.flatnonzero(place > 0), np.flatnonzero(place <= 0)
        held, out = np.ascontiguousarray(points[inside]).reshape(-1), np.empty(9 * len(inside))
        moved = np.ascontiguousarray(moves).reshape(-1)
        maximum_entropy.entropy_jacobians(held, 0, len(inside), *self._shape, moved, out)
        result[inside] = out.reshape(-1, 3, 3)
        if len(beyond):
            result[beyond] = foot_slopes(self.surface, self.surface.closest(points[beyond]), moves)
        return result

    def _place(self, points: Floats) -> NDArray[np.int8]:
        place = self._sign.rows(points)[2]
        if len(points):
            found = self.surface.closest(points)
            place[((points - found.points) ** 2).sum(axis=1) < _NEAR**2] = 0
        return place

    @property
    def _shape(self) -> tuple[Floats, NDArray[np.int64], Floats, NDArray[np.int64], NDArray[np.int64], Floats]:
        surface = self.surface
        areas = surface.planes[:, 15] / 2
        return surface.points.reshape(-1), surface.edges, surface.lines, surface.triangles, surface.sides, areas


def _require_solved(missed: Floats) -> None:
    bad = np.flatnonzero(~(missed < _MISSED))
    if len(bad):
        raise NotConverged(
            f"maximum entropy coordinates of {len(bad)} points did not converge, the first misses its point by "
            f"{missed[bad[0]]:.2g} diagonals: take other coordinates, such as 'harmonic'"
        )
