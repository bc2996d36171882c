"""Natural-neighbour coordinates of many points: which sites influence a point, and how much."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.neighbors.cell_arrays import CellArrays, flat_cells
from pliant.numerics.neighbors.skeleton import Skeleton
from pliant.numerics.neighbors.voronoi import VoronoiCells, nearest_sites

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Kind = Literal["sibson", "laplace"]

CHUNK = 16_384  # points a task, sorted so that neighbours follow each other


@dataclass(frozen=True, eq=False)
class Coordinates:
    """A row of coordinates a point.

    Parameters
    ----------
    starts
        (n + 1,) where each row starts.
    sites
        (e,) which site.
    values
        (e,) its coordinate: not negative, and each row's sum is one.
    gradients
        (e, 3) the derivative with respect to the point, or (0, 3) where it was not asked for; zero at a site.
    """

    starts: Integers
    sites: NDArray[np.int32]
    values: Floats
    gradients: Floats


class SeedGrid(NamedTuple):
    """A grid with a site near each cell: where the search for a point's cell begins.

    Parameters
    ----------
    low, rate, side
        (3,) its corner, (3,) cells a length, and how many cells there are along each axis.
    sites
        (side^3,) a site near each cell's middle.
    """

    low: Floats
    rate: Floats
    side: int
    sites: NDArray[np.int32]

    def order(self, points: Floats) -> Integers:
        """(n,) the points cell by cell."""
        x, y, z = np.clip((points - self.low) * self.rate, 0, self.side - 1).astype(np.uint16).T
        return np.argsort((x * np.uint16(self.side) + y) * np.uint16(self.side) + z, kind="stable")


class Workspace(NamedTuple):
    """What a kernel needs to remember about the point at hand, for m sites, f facets and c corners.

    Parameters
    ----------
    found, slots, sums
        (m,) the cells that lose something; (m,) where each site is among them, or -1; (8 m,) for each of them its
        volume, the area of the cut, its moment (3,) and the moment of its outline (3,).
    stamps
        (2,) numbers that no corner and no facet has yet.
    met, waiting, apart, signed
        (c,) where a corner is among those met, plus the stamp; (c,) which are to be followed; (3 c,) and (c,) where
        those met are, seen from the point, and how much nearer to it.
    asked, touched, areas, crossed, ends
        (f,) where a facet is among those touched, plus the stamp; (f,) which those are; (f,) the area nearer to the
        point; (f,) whether that is a part, and (6 f,) where its outline is cut.
    """

    found: NDArray[np.int32]
    slots: NDArray[np.int32]
    sums: Floats
    stamps: Integers
    met: Integers
    waiting: NDArray[np.int32]
    apart: Floats
    signed: Floats
    asked: Integers
    touched: NDArray[np.int32]
    areas: Floats
    crossed: NDArray[np.int8]
    ends: Floats

    @classmethod
    def of(cls, cells: CellArrays, skeleton: Skeleton) -> Workspace:
        """An empty one."""
        count, facets, corners = cells.number, len(cells.owners), len(skeleton.anchors)
        return cls(
            np.empty(count, np.int32),
            np.full(count, -1, np.int32),
            np.empty(8 * count),
            np.zeros(2, np.int64),
            np.full(corners, -1, np.int64),
            np.empty(corners, np.int32),
            np.empty(3 * corners),
            np.empty(max(corners, int(np.diff(cells.corner_starts).max()))),
            np.full(facets, -1, np.int64),
            np.empty(facets, np.int32),
            np.empty(facets),
            np.empty(facets, np.int8),
            np.empty(6 * facets),
        )


@dataclass(frozen=True, eq=False)
class NaturalNeighbors:
    """Sites, ready to be asked for the coordinates of points.

    Parameters
    ----------
    cells
        The sites' Voronoi cells.
    kind
        ``"sibson"``: shares of the volume that a point would take (Sibson 1980); ``"laplace"``: areas of the facets
        of its cell over distances.
    on_site
        Distance within which a point is the site.
    """

    cells: VoronoiCells
    kind: Kind
    on_site: float

    def at(self, points: Floats, *, gradients: bool = False, limit: int | None = None) -> Coordinates:
        """The coordinates of (n, 3) points, which lie inside the cube of the cells.

        Parameters
        ----------
        points
            (n, 3) positions.
        gradients
            Whether gradients are wanted too.
        limit
            Sites from here on are left out of the rows; None = none is.
        """
        from pliant.numerics.neighbors import sibson, sibson_rows

        cells, flat = self.cells, np.ascontiguousarray(points).reshape(-1)
        kind = sibson_rows.SIBSON if self.kind == "sibson" else sibson_rows.LAPLACE
        arrays, skeleton = self._arrays, self._skeleton
        rounding = 1e-15 * float(np.abs(cells.corners).max())  # of cuts as large as the cube
        end = len(cells.sites) if limit is None else limit
        parts: dict[int, tuple[Integers, NDArray[np.int32], Floats, Floats]] = {}

        def work(start: int, stop: int) -> None:
            order = start + self._seeds.order(points[start:stop])
            rank = np.empty(len(order), np.int64)
            rank[order - start] = np.arange(len(order))
            room = 20 * len(order) + 8 * len(cells.sites)
            while True:
                ends, columns, values = np.empty(len(order), np.int64), np.empty(room, np.int32), np.empty(room)
                slopes = np.empty(3 * room if gradients else 0)
                done = sibson.coordinates(
                    flat, order, arrays, skeleton, self._seeds, Workspace.of(arrays, skeleton), kind, self.on_site,
                    rounding, end, ends, columns, values, slopes,
                )  # fmt: skip
                if done == len(order):
                    break
                room *= 2
            used = int(ends[-1])
            part = np.empty(len(order), np.int64), np.empty(used, np.int32), np.empty(used)
            parts[start] = *part, np.empty(3 * used if gradients else 0)
            sibson_rows.arrange(rank, ends, columns, values, slopes, *parts[start])

        for_chunks(work, len(points), CHUNK)
        pieces = [parts[start] for start in sorted(parts)]
        before = np.cumsum([0, *(len(piece[1]) for piece in pieces)])
        starts = [piece[0] + shift for piece, shift in zip(pieces, before, strict=False)]
        columns = np.concatenate([np.empty(0, np.int32), *(piece[1] for piece in pieces)])
        values = np.concatenate([np.empty(0), *(piece[2] for piece in pieces)])
        slopes = np.concatenate([np.empty(0), *(piece[3] for piece in pieces)])
        return Coordinates(np.concatenate([*starts, before[-1:]]), columns, values, slopes.reshape(-1, 3))

    @cached_property
    def _arrays(self) -> CellArrays:
        return flat_cells(self.cells)

    @cached_property
    def _skeleton(self) -> Skeleton:
        return Skeleton.of(self.cells)

    @cached_property
    def _seeds(self) -> SeedGrid:
        from scipy.spatial import cKDTree

        sites = self.cells.sites
        low, extent = sites.min(axis=0), np.ptp(sites, axis=0)
        side = int(np.clip(np.ceil((64 * len(sites)) ** (1 / 3)), 4, 40))  # 16 bits: they sort fast
        middles = np.stack(np.meshgrid(*[(np.arange(side) + 0.5) / side] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
        near = nearest_sites(cKDTree(sites), low + middles * extent)
        return SeedGrid(low, side / extent, side, near)
