"""Green coordinates (Lipman, Levin & Cohen-Or 2008): weights of vertices and of faces; details keep their shape."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.coordinates import green
from pliant.numerics.meshes.closest_surface import Closest
from pliant.space.coordinates.base import Coordinates
from pliant.space.coordinates.footing import spread_out
from pliant.space.coordinates.surface import Floats

_ROUNDING = 1e-12  # a sum of weights this far from one is one
_NEAR = 1e-9  # of the cage's diagonal: nearer to it than this, the solid angles of edges are noise


class Green(Coordinates):
    """Green coordinates of triangles.

    A point is sum phi_j v_j + sum psi_t n_t inside the cage. The weights phi of a closed cage add up to the winding
    number. Near the surface what rounding takes from their sum is given back at the closest point. Outside, the map
    is continued through the closest face, affinely, so that it passes the cage smoothly there.
    """

    @property
    def width(self) -> int:
        return len(self.surface.points) + len(self.surface.triangles)

    def rows(self, points: Floats) -> tuple[Floats, Floats | None, NDArray[np.int8]]:
        phi, psi, place = self.fine_rows(points)
        return (phi if self.prolongation is None else np.asarray(phi @ self.prolongation)), psi, place

    def fine_rows(self, points: Floats) -> tuple[Floats, Floats, NDArray[np.int8]]:
        """The rows of the surface's own vertices and faces, and where the points are."""
        surface = self.surface
        phi = np.empty((len(points), len(surface.points)))
        psi = np.empty((len(points), len(surface.triangles)))
        green.green_weights(points.reshape(-1), 0, len(points), *self._shape, surface.planes, phi, psi)
        missing = 1 - phi.sum(axis=1)
        doubtful = np.abs(missing) > _ROUNDING
        phi *= np.where(doubtful, 1.0, 1 + missing)[:, None]
        place = np.ones(len(points), np.int8)
        if doubtful.any():
            at = np.flatnonzero(doubtful)
            found = surface.closest(points[at])
            near = ((points[at] - found.points) ** 2).sum(axis=1) < _NEAR**2
            place[at] = np.where(near, 0, np.where(missing[at] < 0.5, 1, -1))
            phi[at] += missing[at, None] * spread_out(surface, found)
            outside = place[at] < 0
            self._continue(points, at[outside], _chosen(found, outside), phi, psi)
        return phi, psi, place

    def slopes(self, points: Floats, moves: Floats, pulls: Floats | None) -> Floats:
        fine = self.prolonged(moves)
        assert pulls is not None
        result = self.fine_slopes(points, fine, pulls)
        outside = np.flatnonzero(self.fine_rows(points)[2] < 0)
        if len(outside):
            face = self.surface.exits(points[outside], self.surface.closest(points[outside]))
            result[outside] += self._tilts(fine)[face].reshape(-1, 3, 3)
            result[outside] += pulls[face][:, :, None] * self.surface.planes[face, None, :3]
        return result

    def fine_slopes(self, points: Floats, moves: Floats, pulls: Floats) -> Floats:
        """As :meth:`slopes`, from (p, 3) moves of the surface's own vertices, without the continuation."""
        out = np.empty(9 * len(points))
        fine, tilts = np.ascontiguousarray(moves), self._tilts(moves)
        pulled = np.ascontiguousarray(pulls)
        green.green_jacobians(
            points.reshape(-1),
            0,
            len(points),
            *self._shape,
            self.surface.planes,
            fine.reshape(-1),
            tilts,
            pulled.reshape(-1),
            out,
        )
        return out.reshape(-1, 3, 3)

    @property
    def _shape(self) -> tuple[Floats, NDArray[np.int64], Floats, NDArray[np.int64], NDArray[np.int64]]:
        surface = self.surface
        return surface.points.reshape(-1), surface.edges, surface.lines, surface.triangles, surface.sides

    def _tilts(self, moves: Floats) -> Floats:
        """(t, 9) the gradient of moves interpolated on each triangle."""
        tilts = np.einsum("tka,tkb->tab", moves[self.surface.triangles], self.surface.gradients)
        return np.ascontiguousarray(tilts.reshape(-1, 9))

    def _continue(self, points: Floats, rows: NDArray[np.int64], found: Closest, phi: Floats, psi: Floats) -> None:
        """Beyond the foot on the exit face, go on as its plane does (Lipman et al. 2008, section 6)."""
        faces = self.surface.exits(points[rows], found)
        beyond = points[rows] - found.points
        along = np.einsum("kcb,kb->kc", self.surface.gradients[faces], beyond)
        phi[rows[:, None], self.surface.triangles[faces]] += along
        psi[rows, faces] += np.einsum("kb,kb->k", self.surface.planes[faces, :3], beyond)


def _chosen(found: Closest, mask: NDArray[np.bool_]) -> Closest:
    return Closest(found.points[mask], found.triangles[mask], found.weights[mask])
