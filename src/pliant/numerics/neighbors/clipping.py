"""A kernel that cuts Voronoi cells out of space, facet by facet.

The facet between a site and another is their bisecting plane, cut by the half-spaces of all the others: convex
polygons in planes, each on its own. Nothing has to be combined, so that nothing goes wrong where many sites lie on
one sphere: a facet that ought to be a point is a tiny polygon, or none.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel


@kernel
def cut_cells(
    chosen, sites, candidates, starts, wall, reach, facet_ends, neighbors, normals, offsets, corner_ends, corners, work
):
    """The facets of some cells, one after another.

    Parameters
    ----------
    chosen
        (k,) sites whose cells are cut.
    sites
        (3 m,) positions.
    candidates, starts
        Sites that may share a facet with ``chosen[k]``: ``candidates[starts[k]:starts[k + 1]]``, the nearest first.
    wall
        Half the edge of the cube about the origin that bounds all cells.
    reach
        (k,) no corner is farther from its site.
    facet_ends, neighbors, normals, offsets
        (k,) where each cell's facets end; for each facet the site behind it (-1: a wall), its outward unit normal
        (3,), and its distance from the cell's own site.
    corner_ends, corners
        Where each facet's corners end; (3,) for each corner, relative to the site, counter-clockwise from outside.
    work
        (2, 3 w) the polygon at hand, and the next.

    Returns
    -------
    facets, small
        How many facets there are, and 0; or which space was too small: 1 facets, 2 corners, 3 polygon.
    """
    facets, places, room = 0, 0, work.shape[1] // 3
    longest = 0
    for cell in range(len(chosen)):
        longest = max(longest, starts[cell + 1] - starts[cell])
    planes = np.empty((longest + 6, 4))
    owners, beyond = np.empty(len(planes), np.int32), np.empty(room)
    for cell in range(len(chosen)):
        others = candidates[starts[cell] : starts[cell + 1]]
        count = _lay_planes(3 * chosen[cell], others, sites, wall, planes, owners)
        for at in range(count):
            size, source = _cut_facet(at, count, planes, reach[cell], work, beyond)
            if size < 0:
                return facets, 3
            if size < 3:
                continue
            if facets == len(neighbors):
                return facets, 1
            if 3 * (places + size) > len(corners):
                return facets, 2
            for n in range(3 * size):
                corners[3 * places + n] = work[source, n]
            places += size
            neighbors[facets], offsets[facets] = owners[at], planes[at, 3]
            for axis in range(3):
                normals[3 * facets + axis] = planes[at, axis]
            corner_ends[facets] = places
            facets += 1
        facet_ends[cell] = facets
    return facets, 0


@inlined
def _lay_planes(own, others, sites, wall, planes, owners):
    """The bisectors of a site and others, and the walls, relative to the site: unit normals and offsets."""
    for at in range(len(others)):
        owners[at] = others[at]
        length = 0.0
        for axis in range(3):
            planes[at, axis] = sites[3 * others[at] + axis] - sites[own + axis]
            length += planes[at, axis] ** 2
        length = np.sqrt(length)
        for axis in range(3):
            planes[at, axis] /= length
        planes[at, 3] = length / 2
    for side in range(6):
        at, axis, sign = len(others) + side, side // 2, 1.0 - 2.0 * (side % 2)
        for other in range(3):
            planes[at, other] = sign if other == axis else 0.0
        planes[at, 3] = wall - sign * sites[own + axis]
        owners[at] = -1
    return len(others) + 6


@inlined
def _cut_facet(at, count, planes, reach, work, beyond):
    """What the other planes leave of one: number of corners, -1 if they may not fit, and which half holds them."""
    _lay_square(planes[at], reach, work[0])
    size, source = 4, 0
    for other in range(count):
        if other != at and size >= 3:
            if 2 * size > len(beyond):
                return -1, 0
            cut = _clip(work[source], size, planes[other], work[1 - source], beyond)
            if cut >= 0:
                size, source = cut, 1 - source
    return size, source


@inlined
def _lay_square(plane, half, polygon):
    """A square in a plane, counter-clockwise about its normal."""
    x, y, z, offset = plane[0], plane[1], plane[2], plane[3]
    if abs(x) <= min(abs(y), abs(z)):
        ux, uy, uz = 0.0, -z, y
    elif abs(y) <= abs(z):
        ux, uy, uz = z, 0.0, -x
    else:
        ux, uy, uz = -y, x, 0.0
    length = half / np.sqrt(ux * ux + uy * uy + uz * uz)
    ux, uy, uz = length * ux, length * uy, length * uz
    vx, vy, vz = y * uz - z * uy, z * ux - x * uz, x * uy - y * ux
    for corner in range(4):
        p, q = (1.0 if corner in (0, 3) else -1.0), (1.0 if corner < 2 else -1.0)
        polygon[3 * corner] = x * offset + p * ux + q * vx
        polygon[3 * corner + 1] = y * offset + p * uy + q * vy
        polygon[3 * corner + 2] = z * offset + p * uz + q * vz


@inlined
def _clip(polygon, size, plane, result, beyond):
    """The corners of a polygon that are kept behind a plane; -1 where nothing is cut off."""
    x, y, z, offset = plane[0], plane[1], plane[2], plane[3]
    outside = False
    for corner in range(size):  # computed once: twice, rounding might disagree about the side
        beyond[corner] = polygon[3 * corner] * x + polygon[3 * corner + 1] * y + polygon[3 * corner + 2] * z - offset
        outside |= beyond[corner] > 0
    if not outside:
        return -1
    kept, last = 0, size - 1
    for corner in range(size):
        s, before = beyond[corner], beyond[last]
        if (s > 0) != (before > 0):
            t = before / (before - s)
            for axis in range(3):
                start = polygon[3 * last + axis]
                result[3 * kept + axis] = start + t * (polygon[3 * corner + axis] - start)
            kept += 1
        if s <= 0:
            for axis in range(3):
                result[3 * kept + axis] = polygon[3 * corner + axis]
            kept += 1
        last = corner
    return kept
