"""A kernel for natural-neighbour coordinates, Sibson's (1980) and Laplace's, with their gradients.

If a point x were a site too, its cell would take from the cell of each old site p what lies nearer to x than to p:
one half-space cut of a cell that is known beforehand. The facets that have something nearer to x hang together by
their corners that are nearer to x: the search goes from corner to corner, beginning in the cell that x lies in. Should
it miss something, the coordinates do not reproduce x, and all facets of all cells that lose something are searched.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compiling import inlined, kernel
from pliant.numerics.lanes import get
from pliant.numerics.sibson_pieces import share

SIBSON, LAPLACE = 0, 1


@kernel
def coordinates(points, first, stop, cells, seeds, kind, on_site, rounding, row_ends, columns, values, slopes):
    """Coordinates of the points ``first:stop`` with respect to the sites.

    Parameters
    ----------
    points
        (3 n,) positions.
    cells, seeds
        As in :class:`pliant.numerics.voronoi.CellArrays` and :class:`pliant.numerics.natural_neighbors.SeedGrid`.
    kind
        SIBSON or LAPLACE.
    on_site
        Distance within which a point is the site.
    rounding
        Distance within which a corner lies on the cut: facets meet to rounding only, and must agree about it.
    row_ends, columns, values
        (stop - first,) where each point's row ends; the sites and their coordinates.
    slopes
        (3 per value) gradients of the coordinates; empty = not wanted.

    Returns
    -------
    int
        How many points were done before ``columns`` was full.
    """
    count, differentiate = len(cells.starts) - 1, len(slopes) > 0
    outlines = differentiate or kind == LAPLACE
    slots, found = np.full(count, -1, np.int32), np.empty(count, np.int32)
    asked, met = np.full(len(cells.owners), -1, np.int64), np.full(len(cells.meeting_starts) - 1, -1, np.int64)
    waiting = np.empty(len(met), np.int32)
    sums = np.empty((count, 8))  # of each cell: volume, area of the cut, its moment (3,), outline's moment (3,)
    signed, ends = np.empty(np.max(np.diff(cells.corner_starts))), np.empty(6)
    filled = 0
    for row in range(first, stop):
        px, py, pz = points[3 * row], points[3 * row + 1], points[3 * row + 2]
        start = _walk(px, py, pz, _seed(px, py, pz, seeds), cells)
        if filled + count > len(columns):
            return row - first
        if _distance(px, py, pz, cells.sites, start) <= on_site:
            columns[filled], values[filled] = start, 1.0
            slopes[3 * filled : 3 * filled + 3] = 0.0
            filled += 1
            row_ends[row - first] = filled
            continue
        for attempt in range(2):
            found[0], slots[start] = start, 0
            sums[0] = 0.0
            size = _search(
                px, py, pz, 2 * row + attempt, attempt == 0, cells, rounding, outlines, signed, ends,
                found, slots, sums, asked, met, waiting,
            )  # fmt: skip
            total = _weigh(px, py, pz, size, found, slots, sums, cells.sites, kind, outlines)
            if _reproduced(px, py, pz, size, found, sums, total, cells.sites):
                break
        filled = _write(size, found, sums, total, differentiate, filled, columns, values, slopes)
        row_ends[row - first] = filled
    return stop - first


@inlined
def _search(
    px, py, pz, stamp, by_corners, cells, rounding, outlines, signed, ends, found, slots, sums, asked, met, waiting
):
    """Sums of all cells that lose something to a point, from the first one found; how many they are.

    Either the first touched facet leads, by its corners, to all others; or all facets of all cells found are asked.
    """
    size, at, queued, begun = 1, 0, 0, False
    while at < size and not begun:
        for place in range(cells.starts[found[at]], cells.starts[found[at] + 1]):
            facet = get(cells.facets, place)
            if not begun and get(asked, facet) != stamp:
                asked[facet] = stamp
                size, touched = share(
                    facet, px, py, pz, cells, rounding, outlines, signed, ends, size, found, slots, sums
                )
                if touched and by_corners:
                    begun = True
                    queued = _meet(facet, stamp, cells, signed, met, waiting, queued)
        at += 1
    while queued > 0:
        queued -= 1
        corner = waiting[queued]
        for place in range(cells.meeting_starts[corner], cells.meeting_starts[corner + 1]):
            facet = get(cells.meeting_facets, place)
            if get(asked, facet) != stamp:
                asked[facet] = stamp
                size, touched = share(
                    facet, px, py, pz, cells, rounding, outlines, signed, ends, size, found, slots, sums
                )
                if touched:
                    queued = _meet(facet, stamp, cells, signed, met, waiting, queued)
    return size


@inlined
def _meet(facet, stamp, cells, signed, met, waiting, queued):
    """Let the corners of a facet that are nearer to the point wait, if they have not been met."""
    base = get(cells.corner_starts, facet)
    for k in range(get(cells.corner_starts, facet + 1) - base):
        corner = get(cells.meetings, base + k)
        if get(signed, k) > 0.0 and get(met, corner) != stamp:
            met[corner] = stamp
            waiting[queued] = corner
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
    for _ in range(len(cells.starts)):
        dx, dy, dz = px - sites[3 * start], py - sites[3 * start + 1], pz - sites[3 * start + 2]
        best, target = 0.0, start
        for place in range(cells.starts[start], cells.starts[start + 1]):
            f = get(cells.facets, place)
            n = 3 * f
            along = dx * get(cells.normals, n) + dy * get(cells.normals, n + 1) + dz * get(cells.normals, n + 2)
            outwards = get(cells.owners, f) == start
            offset, other = get(cells.offsets, f), get(cells.others, f)
            gain = ((along if outwards else -along) - offset) * offset
            if other >= 0 and gain > best:
                best, target = gain, (other if outwards else get(cells.owners, f))
        if target == start:
            break
        start = target
    return start


@inlined
def _distance(px, py, pz, sites, site):
    return np.sqrt((px - sites[3 * site]) ** 2 + (py - sites[3 * site + 1]) ** 2 + (pz - sites[3 * site + 2]) ** 2)


@inlined
def _weigh(px, py, pz, size, found, slots, sums, sites, kind, outlines):
    """From sums to weights, at 0, and their gradients, at 1 to 3; the sum of the weights.

    A volume grows by the cut's area times the cut's motion; the cut's area grows at its outline.
    """
    total = 0.0
    for at in range(size):
        site = found[at]
        slots[site] = -1
        weight = max(sums[at, 0], 0.0) / 3.0
        if outlines:
            dx, dy, dz = px - sites[3 * site], py - sites[3 * site + 1], pz - sites[3 * site + 2]
            distance, area = np.sqrt(dx * dx + dy * dy + dz * dz), sums[at, 1]
            if kind == SIBSON:
                sums[at, 1] = (sums[at, 2] - area * dx) / distance
                sums[at, 2] = (sums[at, 3] - area * dy) / distance
                sums[at, 3] = (sums[at, 4] - area * dz) / distance
            else:
                weight = max(area, 0.0) / distance
                pull = weight / (distance * distance)
                sums[at, 1] = sums[at, 5] / distance - pull * dx
                sums[at, 2] = sums[at, 6] / distance - pull * dy
                sums[at, 3] = sums[at, 7] / distance - pull * dz
        sums[at, 0] = weight
        total += weight
    return total


@inlined
def _reproduced(px, py, pz, size, found, sums, total, sites):
    """Whether the weights' mean of the sites is the point: they are all there."""
    x, y, z, spread = 0.0, 0.0, 0.0, 0.0
    for at in range(size):
        site, weight = 3 * found[at], sums[at, 0]
        dx, dy, dz = get(sites, site) - px, get(sites, site + 1) - py, get(sites, site + 2) - pz
        x, y, z = x + weight * dx, y + weight * dy, z + weight * dz
        spread += weight * (abs(dx) + abs(dy) + abs(dz))
    return total > 0.0 and abs(x) + abs(y) + abs(z) <= 1e-11 * spread


@inlined
def _write(size, found, sums, total, differentiate, filled, columns, values, slopes):
    """One row of coordinates, with gradients if they are wanted; where it ends."""
    x, y, z = 0.0, 0.0, 0.0
    if differentiate:
        for at in range(size):
            x, y, z = x + sums[at, 1], y + sums[at, 2], z + sums[at, 3]
    for at in range(size):
        value = sums[at, 0] / total
        if value > 1e-17:
            columns[filled], values[filled] = found[at], value
            if differentiate:
                slopes[3 * filled] = (sums[at, 1] - value * x) / total
                slopes[3 * filled + 1] = (sums[at, 2] - value * y) / total
                slopes[3 * filled + 2] = (sums[at, 3] - value * z) / total
            filled += 1
    return filled
