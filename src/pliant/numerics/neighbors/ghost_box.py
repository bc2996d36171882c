"""Sites in a box of ghost sites: natural-neighbour interpolation of displacements that vanish at the box.

The ghosts close the cells of the outermost sites and stay at rest, so that displacements fade towards them. A point
close to the faces of the box would take a cell without end; in the outer tenth of the box a smooth factor leads to
zero, beyond the box nothing moves.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from pliant.numerics.neighbors.farin import FarinForm, gradient_fit
from pliant.numerics.neighbors.natural_neighbors import Coordinates, Kind, NaturalNeighbors
from pliant.numerics.neighbors.voronoi import VoronoiCells

Floats = NDArray[np.float64]

FADE = 0.9  # where the outer tenth begins
WALL = 40.0  # half the cube that bounds all cells, in half edges of the box: no point before the fade sees it
NEAR = 20  # sites that a gradient is fitted to, besides the natural neighbours
ON_SITE = 1e-13


@dataclass(frozen=True, eq=False)
class GhostBox:
    """Sites, and the box of eight ghosts around them.

    Parameters
    ----------
    sites
        (k, 3) at least two, no two alike.
    margin
        Distance of the box from the sites' bounding box, as a fraction of its diagonal; at least a quarter.
    kind
        Which coordinates.
    """

    sites: Floats
    margin: float
    kind: Kind

    @cached_property
    def scale(self) -> float:
        """A power of two about as large as the sites' diagonal: lengths are divided by it, exactly."""
        return float(2.0 ** np.round(np.log2(np.linalg.norm(np.ptp(self.sites, axis=0)))))

    @cached_property
    def center(self) -> Floats:
        """(3,) the middle of the box."""
        return np.asarray((self.sites.min(axis=0) + self.sites.max(axis=0)) / 2)

    @cached_property
    def half(self) -> Floats:
        """(3,) half the box's edges, in local units."""
        extent = np.ptp(self.sites, axis=0) / self.scale
        return np.asarray(extent / 2 + self.margin * np.linalg.norm(extent))

    def local(self, points: Floats) -> Floats:
        """(n, 3) positions relative to the middle, in units of the scale."""
        return np.asarray((points - self.center) / self.scale)

    @cached_property
    def everyone(self) -> Floats:
        """(k + 8, 3) the sites and the ghosts, local."""
        corners = np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
        return np.vstack([self.local(self.sites), corners * self.half])

    @cached_property
    def neighbors(self) -> NaturalNeighbors:
        """The sites' cells, and coordinates with respect to them."""
        count = len(self.sites)
        cells = VoronoiCells.of(self.everyone, WALL * float(self.half.max()), np.arange(count, count + 8))
        return NaturalNeighbors(cells, self.kind, ON_SITE)

    @cached_property
    def fit(self) -> csr_array:
        """(3 k, k) from the sites' values to their gradients, per local unit."""
        from scipy.spatial import cKDTree

        cells, count = self.neighbors.cells, len(self.sites)
        inner = (cells.others >= 0) & (cells.others < count) & (cells.owners < count)
        pairs = np.stack([cells.owners[inner], cells.others[inner]], axis=1)
        sites = self.everyone[:count]
        near = cKDTree(sites).query(sites, k=min(NEAR + 1, count))[1]
        around = [set(row.tolist()) - {i} for i, row in enumerate(near)]
        for a, b in pairs.tolist():
            around[a].add(b)
            around[b].add(a)
        return gradient_fit(sites, [np.array(sorted(row), np.int64) for row in around])

    def weights(self, points: Floats) -> csr_array:
        """(n, k) how displacements of the sites move (n, 3) points."""
        local, count = self.local(points), len(self.sites)
        if (np.abs(local) <= FADE * self.half).all():  # the usual case, and much the fastest
            found = self.neighbors.at(local, limit=count)
            return csr_array((found.values, found.sites, found.starts), shape=(len(points), count))
        inside, coordinates, fade, _ = self._sampled(local, gradients=False)
        return self._matrix(len(points), inside, coordinates, coordinates.values * fade[_rows(coordinates)])

    def smooth_weights(self, points: Floats) -> csr_array:
        """(n, 4 k) how the sites' displacements (k), and then their gradients (3 k), move (n, 3) points."""
        inside, coordinates, fade, _ = self._sampled(self.local(points), gradients=False)
        values, slopes = FarinForm(coordinates, self.everyone).weights()
        fading = fade[_rows(coordinates)]
        of_gradients = self._matrix(len(points), inside, coordinates, slopes * fading[:, None])
        from scipy.sparse import hstack

        return csr_array(hstack([self._matrix(len(points), inside, coordinates, values * fading), of_gradients]))

    def slope(self, points: Floats, displacements: Floats, *, smooth: bool) -> Floats:
        """(n, 3, 3) the derivative of the interpolated (k, 3) displacements; at a site the fitted gradient."""
        inside, coordinates, fade, d_fade = self._sampled(self.local(points), gradients=True)
        rows, sites = _rows(coordinates), coordinates.sites
        moves = np.vstack([displacements, np.zeros((8, 3))])
        slopes = np.vstack([self.fit @ displacements, np.zeros((24, 3))]).reshape(-1, 3, 3).transpose(0, 2, 1)
        values, d_values = coordinates.values, coordinates.gradients
        terms = np.zeros((len(rows), 3))
        d_terms = np.zeros((len(rows), 3, 3))
        if smooth:
            form = FarinForm(coordinates, self.everyone)
            (values, along), (d_values, d_along) = form.weights(), form.differentiated()
            terms += np.einsum("eij,ej->ei", slopes[sites], along)
            d_terms += slopes[sites] @ d_along
        terms += values[:, None] * moves[sites]
        d_terms += moves[sites][:, :, None] * d_values[:, None, :]
        count = len(inside)
        total, d_total = np.zeros((count, 3)), np.zeros((count, 3, 3))
        np.add.at(total, rows, terms)
        np.add.at(d_total, rows, d_terms)
        on_site = np.flatnonzero(
            (np.diff(coordinates.starts) == 1) & (coordinates.values[coordinates.starts[:-1]] == 1)
        )
        d_total[on_site] = slopes[sites[coordinates.starts[on_site]]]
        result = np.zeros((len(points), 3, 3))
        result[inside] = (fade[:, None, None] * d_total + total[:, :, None] * d_fade[:, None, :]) / self.scale
        return result

    def _sampled(self, local: Floats, *, gradients: bool) -> tuple[NDArray[np.int64], Coordinates, Floats, Floats]:
        """Which points are in the box, their coordinates, and the factor there with its gradient."""
        inside = np.flatnonzero((np.abs(local) < self.half).all(axis=1))
        local = local[inside]
        t = np.clip((np.abs(local) / self.half - FADE) / (1 - FADE), 0, 1)
        factors = 1 - t**2 * (3 - 2 * t)
        d_factors = -6 * t * (1 - t) * np.sign(local) / (self.half * (1 - FADE))
        others = np.stack([factors[:, [1, 2]], factors[:, [0, 2]], factors[:, [0, 1]]], axis=1).prod(axis=2)
        return inside, self.neighbors.at(local, gradients=gradients), factors.prod(axis=1), d_factors * others

    def _matrix(self, count: int, inside: NDArray[np.int64], coordinates: Coordinates, entries: Floats) -> csr_array:
        """(count, k) or (count, 3 k) of one or three entries a coordinate, without the ghosts'."""
        width = 1 if entries.ndim == 1 else entries.shape[1]
        kept = coordinates.sites < len(self.sites)
        rows, sites = _rows(coordinates)[kept], coordinates.sites[kept].astype(np.int64)
        lengths = np.zeros(count, np.int64)
        lengths[inside] = np.bincount(rows, minlength=len(inside))
        columns = (sites[:, None] * width + np.arange(width)).reshape(-1)
        starts = np.concatenate([[0], np.cumsum(lengths * width)])
        return csr_array((entries[kept].reshape(-1), columns, starts), shape=(count, width * len(self.sites)))


def _rows(coordinates: Coordinates) -> NDArray[np.int64]:
    """(e,) the point that each coordinate belongs to."""
    return np.repeat(np.arange(len(coordinates.starts) - 1), np.diff(coordinates.starts))
