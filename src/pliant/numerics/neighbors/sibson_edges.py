"""Kernel pieces for natural-neighbour coordinates: what a point takes from Voronoi cells, found along their edges.

The corners that are nearer to the point x than to their sites hang together by edges. An edge gives to each facet
beside it the triangle between itself and one of the facet's corners, as far as it is nearer to x; where the outline
leaves and comes back, one more triangle closes it. A facet then gives a cone to the cells on both its sides,
with the apex halfway between x and the site, on the cutting plane: the cut itself never has to be closed.
"""

from __future__ import annotations

from pliant.numerics.compute.compiling import inlined
from pliant.numerics.neighbors.sibson_pieces import join, outline


@inlined
def follow(px, py, pz, start, cells, skeleton, outlines, room):
    """Sums of all cells that lose something to a point; how many they are, or 0 where the first says nothing.

    Parameters
    ----------
    px, py, pz, start
        The point, and the site in whose cell to begin.
    cells, skeleton
        :class:`pliant.numerics.neighbors.cell_arrays.CellArrays` and
        :class:`pliant.numerics.neighbors.skeleton.Skeleton`, as pointers.
    outlines
        Whether areas of cuts and gradients are wanted too.
    room
        As in :class:`pliant.numerics.neighbors.natural_neighbors.Workspace`, as pointers.
    """
    seen, queued = _begin(px, py, pz, start, cells, skeleton, room)
    facets = 0
    while queued > 0:
        queued -= 1
        corner = room.waiting[queued]
        here = room.met[corner] - room.stamps[0]
        for edge in range(skeleton.starts[corner], skeleton.starts[corner + 1]):
            end = skeleton.ends[edge]
            there = room.met[end] - room.stamps[0]
            if there < 0:
                there = seen
                seen, queued = _meet(end, px, py, pz, seen, queued, cells, skeleton, room)
            if room.signed[there] > 0.0:
                if corner < end:  # from the other end, it comes by again
                    facets = _whole(edge, facets, skeleton, room)
            else:
                facets = _part(edge, here, there, facets, skeleton, room)
    size = 0
    for at in range(facets):
        size = _add(at, px, py, pz, size, cells, skeleton, outlines, room)
    room.stamps[0] += seen
    room.stamps[1] += facets
    return size


@inlined
def _begin(px, py, pz, start, cells, skeleton, room):
    """Meet the corners of a cell until one of them is nearer to the point: how many were met, and wait."""
    seen, queued = 0, 0
    for at in range(skeleton.cell_starts[start], skeleton.cell_starts[start + 1]):
        seen, queued = _meet(skeleton.cell_corners[at], px, py, pz, seen, queued, cells, skeleton, room)
        if queued > 0:
            break
    return seen, queued


@inlined
def _meet(corner, px, py, pz, seen, queued, cells, skeleton, room):
    """Remember where a corner is, seen from the point, and how much nearer it is to it; if it is, it waits."""
    site = 3 * skeleton.anchors[corner]
    dx, dy, dz = px - cells.sites[site], py - cells.sites[site + 1], pz - cells.sites[site + 2]
    x, y, z = skeleton.places[3 * corner], skeleton.places[3 * corner + 1], skeleton.places[3 * corner + 2]
    nearer = x * dx + y * dy + z * dz - 0.5 * (dx * dx + dy * dy + dz * dz)
    room.met[corner] = room.stamps[0] + seen
    room.apart[3 * seen], room.apart[3 * seen + 1], room.apart[3 * seen + 2] = x - dx, y - dy, z - dz
    room.signed[seen] = nearer
    if nearer > 0.0:
        room.waiting[queued] = corner
        queued += 1
    return seen + 1, queued


@inlined
def _whole(edge, facets, skeleton, room):
    """Add an edge that is nearer to the point all along to its facets; how many facets there are then."""
    for k in range(skeleton.side_starts[edge], skeleton.side_starts[edge + 1]):
        at = room.asked[skeleton.sides[k] >> 1] - room.stamps[1]
        if at < 0:
            at = facets
            facets = _touch(skeleton.sides[k] >> 1, facets, room)
        room.areas[at] += skeleton.triangles[k]
    return facets


@inlined
def _part(edge, here, there, facets, skeleton, room):
    """Add an edge of which the beginning is nearer to the point, and where that ends, to its facets."""
    part = room.signed[here] / (room.signed[here] - room.signed[there])
    h, t = 3 * here, 3 * there
    x = room.apart[h] + part * (room.apart[t] - room.apart[h])
    y = room.apart[h + 1] + part * (room.apart[t + 1] - room.apart[h + 1])
    z = room.apart[h + 2] + part * (room.apart[t + 2] - room.apart[h + 2])
    for k in range(skeleton.side_starts[edge], skeleton.side_starts[edge + 1]):
        code = skeleton.sides[k]
        at = room.asked[code >> 1] - room.stamps[1]
        if at < 0:
            at = facets
            facets = _touch(code >> 1, facets, room)
        room.areas[at] += part * skeleton.triangles[k]
        room.crossed[at] = 1
        side = 6 * at + 3 * (1 - (code & 1))
        room.ends[side], room.ends[side + 1], room.ends[side + 2] = x, y, z
    return facets


@inlined
def _touch(facet, facets, room):
    """Put a facet among those found; how many those are then."""
    room.asked[facet] = room.stamps[1] + facets
    room.touched[facets], room.crossed[facets], room.areas[facets] = facet, 0, 0.0
    return facets + 1


@inlined
def _add(at, px, py, pz, size, cells, skeleton, outlines, room):
    """Close the outline of a facet's part, and give cones over it to the cells on both sides; how many those are."""
    facet, nearest, ends, base = room.touched[at], skeleton.nearest, room.ends, 6 * at
    own, other = cells.owners[facet], cells.others[facet]
    nx, ny, nz = cells.normals[3 * facet], cells.normals[3 * facet + 1], cells.normals[3 * facet + 2]
    dx, dy, dz = px - cells.sites[3 * own], py - cells.sites[3 * own + 1], pz - cells.sites[3 * own + 2]
    area = room.areas[at]
    if room.crossed[at]:
        mx, my, mz = dx - nearest[3 * facet], dy - nearest[3 * facet + 1], dz - nearest[3 * facet + 2]
        ax, ay, az = ends[base] + mx, ends[base + 1] + my, ends[base + 2] + mz
        bx, by, bz = ends[base + 3] + mx, ends[base + 4] + my, ends[base + 5] + mz
        area += 0.5 * (nx * (ay * bz - az * by) + ny * (az * bx - ax * bz) + nz * (ax * by - ay * bx))
    offset = cells.offsets[facet]
    half = 0.5 * (nx * dx + ny * dy + nz * dz)
    size, place = join(own, size, room)
    room.sums[place] += (offset - half) * area
    if other >= 0:
        size, opposite = join(other, size, room)
        room.sums[opposite] += half * area
    if outlines and room.crossed[at]:
        for k in range(3):
            d = dx if k == 0 else (dy if k == 1 else dz)
            room.ends[base + k] += d
            room.ends[base + 3 + k] += d
        outline(room.sums, place, dx, dy, dz, nx, ny, nz, 0.0, 1.0, ends, base)
        if other >= 0:
            outline(room.sums, opposite, dx, dy, dz, nx, ny, nz, 2.0 * offset, -1.0, ends, base)
    return size
