"""Kernel pieces for natural-neighbour coordinates: what a point takes from Voronoi cells, facet by facet.

Each facet of every cell that loses something is clipped on its own, whatever meets at its corners: slower than along
edges, and nothing is missed.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined


@inlined
def share(facet, px, py, pz, cells, rounding, outlines, size, room):
    """Add what a facet gives to the cells on both sides, which join ``found``.

    Parameters
    ----------
    facet
        Which one.
    px, py, pz
        The point.
    cells
        As in :class:`pliant.numerics.neighbors.cell_arrays.CellArrays`, as pointers.
    rounding
        Distance within which a corner lies on the cut.
    outlines
        Whether areas of cuts and gradients are wanted too.
    size
        How many cells there are.
    room
        As in :class:`pliant.numerics.neighbors.natural_neighbors.Workspace`, as pointers.

    Returns
    -------
    int
        How many cells there are now.
    """
    own, other = cells.owners[facet], cells.others[facet]
    dx, dy, dz = px - cells.sites[3 * own], py - cells.sites[3 * own + 1], pz - cells.sites[3 * own + 2]
    area, crossings = _kept(facet, dx, dy, dz, cells, rounding, room.signed, room.ends)
    if area < 0.0:
        return size
    nx, ny, nz = cells.normals[3 * facet], cells.normals[3 * facet + 1], cells.normals[3 * facet + 2]
    offset = cells.offsets[facet]
    half = 0.5 * (nx * dx + ny * dy + nz * dz)
    for side in range(1 if other < 0 else 2):
        site = own if side == 0 else other
        size, at = join(site, size, room)
        room.sums[at] += (offset - half if side == 0 else half) * area
        if crossings and outlines:
            outline(room.sums, at, dx, dy, dz, nx, ny, nz, 2.0 * offset * side, 1.0 - 2.0 * side, room.ends, 0)
    return size


@inlined
def join(site, size, room):
    """Put a cell among those found; how many those are then, and where its sums start."""
    at = room.slots[site]
    if at >= 0:
        return size, 8 * at
    room.slots[site], room.found[size] = size, site
    for k in range(8):
        room.sums[8 * size + k] = 0.0
    return size + 1, 8 * size


@inlined
def _kept(facet, dx, dy, dz, cells, rounding, signed, ends):
    """The area of a facet nearer to a point than to the site, and how often its outline crosses; -1 if none is.

    ``ends`` receives where the outline leaves (3,) what is nearer to the point, and where it comes back (3,).
    """
    base, size = cells.corner_starts[facet], cells.corner_starts[facet + 1] - cells.corner_starts[facet]
    shift = 0.5 * (dx * dx + dy * dy + dz * dz)
    least = rounding * np.sqrt(2.0 * shift)
    nearer = 0
    for k in range(size):
        n = 3 * (base + k)
        s = cells.corners[n] * dx + cells.corners[n + 1] * dy + cells.corners[n + 2] * dz - shift
        signed[k] = s if abs(s) > least else 0.0
        nearer += s > least
    if nearer == 0:
        return -1.0, 0
    if nearer == size:
        return cells.areas[facet], 0
    crossings, empty = 0, True
    x0 = y0 = z0 = x1 = y1 = z1 = 0.0  # the first corner kept, and the last
    cx = cy = cz = 0.0  # twice the area vector
    last = size - 1
    before = signed[last]
    for k in range(size):
        s, n = signed[k], 3 * (base + k)
        vx, vy, vz = cells.corners[n], cells.corners[n + 1], cells.corners[n + 2]
        if (s > 0.0) != (before > 0.0):
            m, t = 3 * (base + last), before / (before - s)
            wx, wy, wz = cells.corners[m], cells.corners[m + 1], cells.corners[m + 2]
            ux, uy, uz = wx + t * (vx - wx), wy + t * (vy - wy), wz + t * (vz - wz)
            side = 0 if before > 0.0 else 3
            ends[side] = ux
            ends[side + 1] = uy
            ends[side + 2] = uz
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
    nx, ny, nz = cells.normals[3 * facet], cells.normals[3 * facet + 1], cells.normals[3 * facet + 2]
    return max(0.5 * (cx * nx + cy * ny + cz * nz), 0.0), crossings


@inlined
def outline(sums, at, dx, dy, dz, nx, ny, nz, apart, sign, ends, base):
    """Add an edge of the cut's outline to the sums of the cut's area, moment and outline.

    The facet's normal is seen from its owner, ``d`` and ``ends``, from ``base`` on, are relative to it; the cell whose
    sums these are has its site ``apart`` along the normal.
    """
    sx, sy, sz = apart * nx, apart * ny, apart * nz
    dx, dy, dz = dx - sx, dy - sy, dz - sz
    ex, ey, ez = ends[base] - sx, ends[base + 1] - sy, ends[base + 2] - sz
    bx, by, bz = ends[base + 3] - sx, ends[base + 4] - sy, ends[base + 5] - sz
    ax, ay, az = 0.5 * dx, 0.5 * dy, 0.5 * dz
    distance = np.sqrt(dx * dx + dy * dy + dz * dz)
    ox, oy, oz, wx, wy, wz = ex - ax, ey - ay, ez - az, bx - ax, by - ay, bz - az
    area = dx * (oy * wz - oz * wy) + dy * (oz * wx - ox * wz) + dz * (ox * wy - oy * wx)
    area *= 0.5 * sign / distance
    sums[at + 1] += area
    sums[at + 2] += area * (ax + ex + bx) / 3.0
    sums[at + 3] += area * (ay + ey + by) / 3.0
    sums[at + 4] += area * (az + ez + bz) / 3.0
    along = sign * (nx * dx + ny * dy + nz * dz) / distance
    length = np.sqrt((bx - ex) ** 2 + (by - ey) ** 2 + (bz - ez) ** 2)
    share = along / np.sqrt(max(1.0 - along * along, 1e-30)) * length / distance
    sums[at + 5] += share * (0.5 * (ex + bx) - dx)
    sums[at + 6] += share * (0.5 * (ey + by) - dy)
    sums[at + 7] += share * (0.5 * (ez + bz) - dz)
