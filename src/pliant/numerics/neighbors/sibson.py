"""A kernel for natural-neighbour coordinates, Sibson's (1980) and Laplace's, with their gradients.

If a point x were a site too, its cell would take from the cell of each old site p what lies nearer to x than to p:
one half-space cut of a cell that is known beforehand. The facets that have something nearer to x hang together by
their corners that are nearer to x: the search goes from corner to corner, beginning in the cell that x lies in. Should
it miss something, the coordinates do not reproduce x, and all facets of all cells that lose something are searched.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel
from pliant.numerics.compute.pointers import pointer
from pliant.numerics.neighbors.cell_arrays import CellArrays
from pliant.numerics.neighbors.natural_neighbors import Workspace
from pliant.numerics.neighbors.sibson_pieces import share
from pliant.numerics.neighbors.sibson_rows import LAPLACE, reproduced, weigh, write


@kernel
def coordinates(points, order, cells, seeds, room, kind, on_site, rounding, limit, row_ends, columns, values, slopes):
    """Coordinates of some points with respect to the sites.

    Parameters
    ----------
    points, order
        (3 n,) positions, and (k,) which of them to take, one after another: best neighbours together.
    cells, seeds, room
        As in :class:`pliant.numerics.neighbors.cell_arrays.CellArrays`, and :class:`SeedGrid` and :class:`Workspace` of
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
    cells, room = _pointed(cells), _pointed_room(room)
    differentiate = len(slopes) > 0
    outlines = differentiate or kind == LAPLACE
    filled = 0
    for row in range(len(order)):
        n = 3 * order[row]
        px, py, pz = points[n], points[n + 1], points[n + 2]
        start = _walk(px, py, pz, _seed(px, py, pz, seeds), cells)
        if filled + cells.number > len(columns):
            return row
        if _distance(px, py, pz, cells.sites, start) <= on_site:
            if start < limit:
                columns[filled], values[filled] = start, 1.0
                if differentiate:
                    slopes[3 * filled] = slopes[3 * filled + 1] = slopes[3 * filled + 2] = 0.0
                filled += 1
            row_ends[row] = filled
            continue
        for attempt in range(2):
            size = _search(px, py, pz, start, 2 * row + attempt, attempt == 0, cells, rounding, outlines, room)
            total = weigh(px, py, pz, size, room, cells.sites, kind, outlines)
            if reproduced(px, py, pz, size, room, total, cells.sites):
                break
        filled = write(size, room, total, limit, differentiate, filled, columns, values, slopes)
        row_ends[row] = filled
    return len(order)


@inlined
def _pointed(cells):
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
        pointer(cells.meetings),
        pointer(cells.meeting_starts),
        pointer(cells.meeting_facets),
    )


@inlined
def _pointed_room(room):
    return Workspace(
        pointer(room.found),
        pointer(room.slots),
        pointer(room.sums),
        pointer(room.asked),
        pointer(room.met),
        pointer(room.waiting),
        pointer(room.signed),
        pointer(room.ends),
    )


@inlined
def _search(px, py, pz, start, stamp, by_corners, cells, rounding, outlines, room):
    """Sums of all cells that lose something to a point in the cell of ``start``; how many they are.

    Either the first touched facet leads, by its corners, to all others; or all facets of all cells found are asked.
    """
    room.found[0], room.slots[start] = start, 0
    for k in range(8):
        room.sums[k] = 0.0
    size, at, queued, begun = 1, 0, 0, False
    source, place, end = cells.facets, 0, 0
    while True:
        if place == end:
            if queued > 0:
                queued -= 1
                corner = room.waiting[queued]
                source, place, end = (
                    cells.meeting_facets,
                    cells.meeting_starts[corner],
                    cells.meeting_starts[corner + 1],
                )
            elif at < size and not begun:
                cell = room.found[at]
                source, place, end = cells.facets, cells.starts[cell], cells.starts[cell + 1]
                at += 1
            else:
                return size
            continue
        facet = source[place]
        place += 1
        if room.asked[facet] != stamp:
            room.asked[facet] = stamp
            size, touched = share(facet, px, py, pz, cells, rounding, outlines, size, room)
            if touched and by_corners:
                begun = True
                queued = _meet(facet, stamp, cells, room, queued)


@inlined
def _meet(facet, stamp, cells, room, queued):
    """Let the corners of a facet that are nearer to the point wait, if they have not been met."""
    base = cells.corner_starts[facet]
    for k in range(cells.corner_starts[facet + 1] - base):
        corner = cells.meetings[base + k]
        if room.signed[k] > 0.0 and room.met[corner] != stamp:
            room.met[corner] = stamp
            room.waiting[queued] = corner
            queued += 1
    return queued


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
