"""A kernel for natural-neighbour coordinates, Sibson's (1980) and Laplace's, with their gradients.

If a point x were a site too, its cell would take from the cell of each old site p what lies nearer to x than to p:
one half-space cut of a cell that is known beforehand. The search goes along the cells' edges, beginning in a cell near
x. Should it miss something, the coordinates do not reproduce x; then it begins in the cell that x lies in, and at last
all facets of all cells that lose something are searched.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel
from pliant.numerics.compute.pointers import pointer
from pliant.numerics.neighbors.cell_arrays import CellArrays
from pliant.numerics.neighbors.natural_neighbors import Workspace
from pliant.numerics.neighbors.sibson_edges import follow
from pliant.numerics.neighbors.sibson_pieces import join, share
from pliant.numerics.neighbors.sibson_rows import LAPLACE, only, reproduced, weigh, write
from pliant.numerics.neighbors.skeleton import Skeleton

BESIDE = 10.0  # times the distance on a site: there, rounding may hide what a point takes from the cell


@kernel
def coordinates(
    points, order, cells, skeleton, seeds, room, kind, on_site, rounding, limit, row_ends, columns, values, slopes
):
    """Coordinates of some points with respect to the sites.

    Parameters
    ----------
    points, order
        (3 n,) positions, and (k,) which of them to take, one after another: best neighbours together.
    cells, skeleton, seeds, room
        :class:`pliant.numerics.neighbors.cell_arrays.CellArrays`,
        :class:`pliant.numerics.neighbors.skeleton.Skeleton`, and :class:`SeedGrid` and :class:`Workspace` of
        :mod:`pliant.numerics.neighbors.natural_neighbors`.
    kind
        SIBSON or LAPLACE.
    on_site
        Distance within which a point is the site.
    rounding
        Distance within which a corner lies on the cut: facets meet to rounding only, and must agree about it.
    limit
        Sites from here on are left out of the rows.
    row_ends, columns, values
        (k,) where each point's row ends; the sites and their coordinates.
    slopes
        (3 per value) gradients of the coordinates; empty = not wanted.

    Returns
    -------
    int
        How many points were done before ``columns`` was full.
    """
    cells, skeleton, room = _pointed_cells(cells), _pointed_skeleton(skeleton), _pointed_room(room)
    differentiate = len(slopes) > 0
    outlines = differentiate or kind == LAPLACE
    filled = 0
    for row in range(len(order)):
        n = 3 * order[row]
        px, py, pz = points[n], points[n + 1], points[n + 2]
        if filled + cells.number > len(columns):
            return row
        start, size, total, settled, away = _seed(px, py, pz, seeds), 0, 0.0, False, np.inf
        for attempt in range(3):  # from a near cell; from the point's own; facet by facet
            if attempt < 2:
                size = follow(px, py, pz, start, cells, skeleton, outlines, room)
            else:
                size = _search(px, py, pz, start, cells, rounding, outlines, room)
            total = weigh(px, py, pz, size, room, cells.sites, kind, outlines)
            settled = reproduced(px, py, pz, size, room, total, cells.sites, on_site)
            if attempt == 0 and not settled:
                start = _walk(px, py, pz, start, cells)
                away = _distance(px, py, pz, cells.sites, start)
            if settled or away <= on_site:
                break
        if not settled and (away <= BESIDE * on_site or not total > 0.0):
            size, total = only(start, room)
        filled = write(size, room, total, limit, differentiate, filled, columns, values, slopes)
        row_ends[row] = filled
    return len(order)


@inlined
def _pointed_cells(cells):
    return CellArrays(
        cells.number,
        pointer(cells.sites),
        pointer(cells.starts),
        pointer(cells.facets),
        pointer(cells.owners),
        pointer(cells.others),
        pointer(cells.normals),
        pointer(cells.offsets),
        pointer(cells.areas),
        pointer(cells.corner_starts),
        pointer(cells.corners),
    )


@inlined
def _pointed_skeleton(skeleton):
    return Skeleton(
        pointer(skeleton.anchors),
        pointer(skeleton.places),
        pointer(skeleton.starts),
        pointer(skeleton.ends),
        pointer(skeleton.side_starts),
        pointer(skeleton.sides),
        pointer(skeleton.triangles),
        pointer(skeleton.nearest),
        pointer(skeleton.cell_starts),
        pointer(skeleton.cell_corners),
    )


@inlined
def _pointed_room(room):
    return Workspace(
        pointer(room.found),
        pointer(room.slots),
        pointer(room.sums),
        pointer(room.stamps),
        pointer(room.met),
        pointer(room.waiting),
        pointer(room.apart),
        pointer(room.signed),
        pointer(room.asked),
        pointer(room.touched),
        pointer(room.areas),
        pointer(room.crossed),
        pointer(room.ends),
    )


@inlined
def _search(px, py, pz, start, cells, rounding, outlines, room):
    """Sums of all cells that lose something to a point in the cell of ``start``; how many they are."""
    stamp = room.stamps[1]  # one that no facet has
    room.stamps[1] += 1
    size, at = join(start, 0, room)
    while at < size:
        cell = room.found[at]
        for place in range(cells.starts[cell], cells.starts[cell + 1]):
            facet = cells.facets[place]
            if room.asked[facet] != stamp:
                room.asked[facet] = stamp
                size = share(facet, px, py, pz, cells, rounding, outlines, size, room)
        at += 1
    return size


@inlined
def _seed(px, py, pz, seeds):
    """A site near a point."""
    i = min(max(int((px - seeds.low[0]) * seeds.rate[0]), 0), seeds.side - 1)
    j = min(max(int((py - seeds.low[1]) * seeds.rate[1]), 0), seeds.side - 1)
    k = min(max(int((pz - seeds.low[2]) * seeds.rate[2]), 0), seeds.side - 1)
    return seeds.sites[(i * seeds.side + j) * seeds.side + k]


@inlined
def _walk(px, py, pz, start, cells):
    """The site whose cell holds a point: from cell to cell, always nearer."""
    sites = cells.sites
    for _ in range(cells.number):
        dx, dy, dz = px - sites[3 * start], py - sites[3 * start + 1], pz - sites[3 * start + 2]
        best, target = 0.0, start
        for place in range(cells.starts[start], cells.starts[start + 1]):
            f = cells.facets[place]
            n = 3 * f
            along = dx * cells.normals[n] + dy * cells.normals[n + 1] + dz * cells.normals[n + 2]
            outwards = cells.owners[f] == start
            offset, other = cells.offsets[f], cells.others[f]
            gain = ((along if outwards else -along) - offset) * offset
            if other >= 0 and gain > best:
                best, target = gain, (other if outwards else cells.owners[f])
        if target == start:
            break
        start = target
    return start


@inlined
def _distance(px, py, pz, sites, site):
    return np.sqrt((px - sites[3 * site]) ** 2 + (py - sites[3 * site + 1]) ** 2 + (pz - sites[3 * site + 2]) ** 2)
