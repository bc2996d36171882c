"""A kernel for natural-neighbour coordinates, Sibson's (1980) and Laplace's, with their gradients.

If a point x were a site too, its cell would take from the cell of each old site p what lies nearer to x than to p:
one half-space cut of a cell that is known beforehand. Cells that lose something are found from the one that x lies
in, through every facet that has a corner nearer to x. Volumes are sums of cones over facets, with the apex halfway
between x and p, on the cutting plane: the cut itself never has to be closed. What a facet keeps serves the cells on
both its sides.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compiling import inlined, kernel
from pliant.numerics.lanes import get, put

SIBSON, LAPLACE = 0, 1


@kernel
def coordinates(
    points, first, stop, sites, cell_starts, cell_facets, owners, others, normals, offsets, corner_starts, corners,
    seed_frame, seed_counts, seeds, kind, on_site, rounding, row_ends, columns, values, slopes,
):  # fmt: skip
    """Coordinates of the points ``first:stop`` with respect to the sites.

    Parameters
    ----------
    points, sites
        (3 n,), (3 m,) positions.
    cell_starts ... corners
        As in :class:`pliant.numerics.voronoi.VoronoiCells`; normals and corners flat.
    seed_frame, seed_counts, seeds
        (2, 3) origin and inverse spacing of a grid, (3,) its cells, and a site near each: where a search begins.
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
    count = len(cell_starts) - 1
    slots, asked = np.full(count, -1, np.int32), np.full(len(owners), -1, np.int32)
    found = np.empty(count, np.int32)
    differentiate = len(slopes) > 0
    outlines = differentiate or kind == LAPLACE
    sums = np.empty((count, 8))  # of each cell: volume, area of the cut, its moment (3,), outline's moment (3,)
    signed = np.empty(np.max(np.diff(corner_starts)))
    ends = np.empty(6)
    filled = 0
    for row in range(first, stop):
        px, py, pz = points[3 * row], points[3 * row + 1], points[3 * row + 2]
        start = _seed(px, py, pz, seed_frame, seed_counts, seeds)
        start = _walk(px, py, pz, start, sites, cell_starts, cell_facets, owners, others, normals, offsets)
        found[0], slots[start], size, at = start, 0, 1, 0
        sums[0] = 0.0
        dx, dy, dz = px - sites[3 * start], py - sites[3 * start + 1], pz - sites[3 * start + 2]
        if dx * dx + dy * dy + dz * dz <= on_site * on_site:
            if filled == len(columns):
                return row - first
            columns[filled], values[filled] = start, 1.0
            slopes[3 * filled : 3 * filled + 3] = 0.0
            slots[start] = -1
            filled += 1
            row_ends[row - first] = filled
            continue
        while at < size:
            for place in range(cell_starts[found[at]], cell_starts[found[at] + 1]):
                facet = get(cell_facets, place)
                if get(asked, facet) != row - first:
                    asked[facet] = row - first
                    size = _share(
                        facet, px, py, pz, sites, owners, others, normals, offsets, corner_starts, corners,
                        rounding, outlines, signed, ends, size, found, slots, sums,
                    )  # fmt: skip
            at += 1
        if filled + size > len(columns):
            return row - first
        filled = _finish(
            px, py, pz, size, found, slots, sums, sites, kind, differentiate, filled, columns, values, slopes
        )
        row_ends[row - first] = filled
    return stop - first


@inlined
def _seed(px, py, pz, frame, counts, seeds):
    """A site near a point."""
    i = min(max(int((px - frame[0, 0]) * frame[1, 0]), 0), counts[0] - 1)
    j = min(max(int((py - frame[0, 1]) * frame[1, 1]), 0), counts[1] - 1)
    k = min(max(int((pz - frame[0, 2]) * frame[1, 2]), 0), counts[2] - 1)
    return seeds[(i * counts[1] + j) * counts[2] + k]


@inlined
def _walk(px, py, pz, start, sites, cell_starts, cell_facets, owners, others, normals, offsets):
    """The site whose cell holds a point: from cell to cell, always nearer."""
    for _ in range(len(cell_starts)):
        dx, dy, dz = px - sites[3 * start], py - sites[3 * start + 1], pz - sites[3 * start + 2]
        best, target = 0.0, start
        for place in range(cell_starts[start], cell_starts[start + 1]):
            f = get(cell_facets, place)
            along = dx * get(normals, 3 * f) + dy * get(normals, 3 * f + 1) + dz * get(normals, 3 * f + 2)
            outwards = owners[f] == start
            beyond = (along if outwards else -along) - get(offsets, f)
            if others[f] >= 0 and beyond * offsets[f] > best:
                best, target = beyond * offsets[f], (others[f] if outwards else owners[f])
        if target == start:
            break
        start = target
    return start


@inlined
def _share(
    facet, px, py, pz, sites, owners, others, normals, offsets, corner_starts, corners,
    rounding, outlines, signed, ends, size, found, slots, sums,
):  # fmt: skip
    """Add what a facet gives to the cells on both sides, which join ``found``; how many those are then."""
    own, other = get(owners, facet), get(others, facet)
    dx, dy, dz = px - get(sites, 3 * own), py - get(sites, 3 * own + 1), pz - get(sites, 3 * own + 2)
    area, crossings = _kept(facet, dx, dy, dz, corner_starts, corners, normals, rounding, signed, ends)
    if area < 0.0:
        return size
    for site in (own, other):
        if site >= 0 and slots[site] < 0:
            slots[site], found[size] = size, site
            sums[size] = 0.0
            size += 1
    nx, ny, nz = get(normals, 3 * facet), get(normals, 3 * facet + 1), get(normals, 3 * facet + 2)
    offset = get(offsets, facet)
    half = 0.5 * (nx * dx + ny * dy + nz * dz)
    sums[slots[own], 0] += (offset - half) * area
    if other >= 0:
        sums[slots[other], 0] += half * area
    if crossings and outlines:
        _outline(sums[slots[own]], dx, dy, dz, nx, ny, nz, 0.0, 1.0, ends)
        if other >= 0:
            _outline(sums[slots[other]], dx, dy, dz, nx, ny, nz, 2.0 * offset, -1.0, ends)
    return size


@inlined
def _kept(facet, dx, dy, dz, corner_starts, corners, normals, rounding, signed, ends):
    """The area of a facet nearer to a point than to the site, and how often its outline crosses; -1 if none is.

    ``ends`` receives where the outline leaves (3,) what is nearer to the point, and where it comes back (3,).
    """
    base, size = corner_starts[facet], corner_starts[facet + 1] - corner_starts[facet]
    shift = 0.5 * (dx * dx + dy * dy + dz * dz)
    least = rounding * np.sqrt(2.0 * shift)
    touched = False
    for k in range(size):
        n = 3 * (base + k)
        s = get(corners, n) * dx + get(corners, n + 1) * dy + get(corners, n + 2) * dz - shift
        put(signed, k, s if abs(s) > least else 0.0)
        touched |= s > least
    if not touched:
        return -1.0, 0
    crossings, empty = 0, True
    x0 = y0 = z0 = x1 = y1 = z1 = 0.0  # the first corner kept, and the last
    cx = cy = cz = 0.0  # twice the area vector
    last = size - 1
    before = get(signed, last)
    for k in range(size):
        s, n = get(signed, k), 3 * (base + k)
        vx, vy, vz = get(corners, n), get(corners, n + 1), get(corners, n + 2)
        if (s > 0.0) != (before > 0.0):
            m, t = 3 * (base + last), before / (before - s)
            wx, wy, wz = get(corners, m), get(corners, m + 1), get(corners, m + 2)
            ux, uy, uz = wx + t * (vx - wx), wy + t * (vy - wy), wz + t * (vz - wz)
            side = 0 if before > 0.0 else 3
            put(ends, side, ux)
            put(ends, side + 1, uy)
            put(ends, side + 2, uz)
            crossings += 1
            if empty:
                x0, y0, z0, empty = ux, uy, uz, False
            else:
                cx += (y1 - y0) * (uz - z0) - (z1 - z0) * (uy - y0)
                cy += (z1 - z0) * (ux - x0) - (x1 - x0) * (uz - z0)
                cz += (x1 - x0) * (uy - y0) - (y1 - y0) * (ux - x0)
            x1, y1, z1 = ux, uy, uz
        if s > 0.0:
            if empty:
                x0, y0, z0, empty = vx, vy, vz, False
            else:
                cx += (y1 - y0) * (vz - z0) - (z1 - z0) * (vy - y0)
                cy += (z1 - z0) * (vx - x0) - (x1 - x0) * (vz - z0)
                cz += (x1 - x0) * (vy - y0) - (y1 - y0) * (vx - x0)
            x1, y1, z1 = vx, vy, vz
        before, last = s, k
    nx, ny, nz = get(normals, 3 * facet), get(normals, 3 * facet + 1), get(normals, 3 * facet + 2)
    return max(0.5 * (cx * nx + cy * ny + cz * nz), 0.0), crossings


@inlined
def _outline(sums, dx, dy, dz, nx, ny, nz, apart, sign, ends):
    """Add an edge of the cut's outline to the sums of the cut's area, moment and outline.

    The facet's normal is seen from its owner, ``d`` and ``ends`` are relative to it; the cell whose sums these are
    has its site ``apart`` along the normal.
    """
    sx, sy, sz = apart * nx, apart * ny, apart * nz
    dx, dy, dz = dx - sx, dy - sy, dz - sz
    ex, ey, ez = ends[0] - sx, ends[1] - sy, ends[2] - sz
    bx, by, bz = ends[3] - sx, ends[4] - sy, ends[5] - sz
    ax, ay, az = 0.5 * dx, 0.5 * dy, 0.5 * dz
    distance = np.sqrt(dx * dx + dy * dy + dz * dz)
    ox, oy, oz, wx, wy, wz = ex - ax, ey - ay, ez - az, bx - ax, by - ay, bz - az
    area = dx * (oy * wz - oz * wy) + dy * (oz * wx - ox * wz) + dz * (ox * wy - oy * wx)
    area *= 0.5 * sign / distance
    sums[1] += area
    sums[2] += area * (ax + ex + bx) / 3.0
    sums[3] += area * (ay + ey + by) / 3.0
    sums[4] += area * (az + ez + bz) / 3.0
    along = sign * (nx * dx + ny * dy + nz * dz) / distance
    length = np.sqrt((bx - ex) ** 2 + (by - ey) ** 2 + (bz - ez) ** 2)
    share = along / np.sqrt(max(1.0 - along * along, 1e-30)) * length / distance
    sums[5] += share * (0.5 * (ex + bx) - dx)
    sums[6] += share * (0.5 * (ey + by) - dy)
    sums[7] += share * (0.5 * (ez + bz) - dz)


@inlined
def _finish(px, py, pz, size, found, slots, sums, sites, kind, differentiate, filled, columns, values, slopes):
    """One row of coordinates from the sums of its cells; where it ends.

    A volume grows by the cut's area times the cut's motion; the cut's area grows at its outline.
    """
    total, tx, ty, tz = 0.0, 0.0, 0.0, 0.0
    for at in range(size):
        site = found[at]
        slots[site] = -1
        weight = max(sums[at, 0], 0.0) / 3.0
        if differentiate or kind == LAPLACE:
            dx, dy, dz = px - sites[3 * site], py - sites[3 * site + 1], pz - sites[3 * site + 2]
            distance, area = np.sqrt(dx * dx + dy * dy + dz * dz), sums[at, 1]
            if kind == SIBSON:
                gx = (sums[at, 2] - area * dx) / distance
                gy = (sums[at, 3] - area * dy) / distance
                gz = (sums[at, 4] - area * dz) / distance
            else:
                weight = max(area, 0.0) / distance
                pull = weight / (distance * distance)
                gx = sums[at, 5] / distance - pull * dx
                gy = sums[at, 6] / distance - pull * dy
                gz = sums[at, 7] / distance - pull * dz
            sums[at, 1], sums[at, 2], sums[at, 3] = gx, gy, gz
            tx, ty, tz = tx + gx, ty + gy, tz + gz
        sums[at, 0] = weight
        total += weight
    for at in range(size):
        value = sums[at, 0] / total
        if value > 1e-17:
            columns[filled], values[filled] = found[at], value
            if differentiate:
                slopes[3 * filled] = (sums[at, 1] - value * tx) / total
                slopes[3 * filled + 1] = (sums[at, 2] - value * ty) / total
                slopes[3 * filled + 2] = (sums[at, 3] - value * tz) / total
            filled += 1
    return filled
