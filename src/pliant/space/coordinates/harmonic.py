"""Harmonic coordinates by boundary elements: local, hardly ever negative, without a mesh of the volume.

A harmonic function is given inside by its values u and its slopes q on the boundary, by Green's third identity:
u(x) = sum phi u + sum psi q, with the weights of Green coordinates. On a cage cut finer, with values linear on each
triangle and one slope a triangle, the slopes follow from the identity at the triangles' centres.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from pliant.errors import InvalidDeformer
from pliant.numerics.compute.chunks import for_chunks
from pliant.space.coordinates.base import Coordinates
from pliant.space.coordinates.footing import foot_slopes, spread_out
from pliant.space.coordinates.green import Green
from pliant.space.coordinates.surface import CageSurface, Floats

MOST = 12_000  # triangles: their equations fill a gigabyte


class Harmonic(Coordinates):
    """Harmonic coordinates (Joshi et al. 2007), solved on the cage's surface.

    They are as exact as the finer cage: linear functions are reproduced at every level, weights that should be zero
    or more reach down to -0.04, -0.02 and -0.001 at levels 0, 1 and 2. Outside, a point follows the closest point of
    the cage.

    Raises
    ------
    InvalidDeformer
        More triangles than equations can be solved for.
    """

    bounded = True

    def __init__(self, surface: CageSurface, prolongation: csr_array) -> None:
        super().__init__(surface, prolongation)
        if len(surface.triangles) > MOST:
            raise InvalidDeformer(
                f"harmonic coordinates would need {len(surface.triangles):,} boundary elements, {MOST:,} is the most: "
                "take a coarser cage, or fewer levels"
            )
        self._green = Green(surface)
        self._down = prolongation
        self._fluxes = self._solved(prolongation)

    @property
    def width(self) -> int:
        return self._green.width

    def _solved(self, prolongation: csr_array) -> Floats:
        """(t, m) Q: the slope on each triangle, from values at the cage's vertices."""
        from scipy.linalg import lu_factor, lu_solve

        surface = self.surface
        count = len(surface.triangles)
        centers = surface.corners.mean(axis=1)
        difference, psi = np.empty((count, len(surface.points))), np.empty((count, count))

        def work(first: int, stop: int) -> None:
            phi, psi[first:stop], _ = self._green.fine_rows(centers[first:stop])
            difference[first:stop] = -phi
            corners = surface.triangles[first:stop]
            difference[np.arange(first, stop)[:, None], corners] += 1 / 3

        for_chunks(work, count, self.piece)
        given = np.ascontiguousarray(difference @ prolongation)
        return np.asarray(lu_solve(lu_factor(psi, overwrite_a=True), given))

    def rows(self, points: Floats) -> tuple[Floats, Floats | None, NDArray[np.int8]]:
        phi, psi, place = self._green.fine_rows(points)
        weights = np.asarray(phi @ self._down) + psi @ self._fluxes
        beyond = np.flatnonzero(place <= 0)
        if len(beyond):
            found = self.surface.closest(points[beyond])
            weights[beyond] = spread_out(self.surface, found) @ self._down
        return weights, None, place

    def slopes(self, points: Floats, moves: Floats, pulls: Floats | None) -> Floats:
        fine = self.prolonged(moves)
        result = self._green.fine_slopes(points, fine, self._fluxes @ moves)
        beyond = np.flatnonzero(self._green.fine_rows(points)[2] <= 0)
        if len(beyond):
            result[beyond] = foot_slopes(self.surface, self.surface.closest(points[beyond]), fine)
        return result
