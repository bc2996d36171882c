"""Kernel pieces for natural-neighbour coordinates: from sums of volumes and areas to rows of coordinates."""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel

SIBSON, LAPLACE = 0, 1


@kernel
def arrange(rank, row_ends, columns, values, slopes, starts, sorted_columns, sorted_values, sorted_slopes):
    """Rows in the order of their points: ``rank`` says where each is in the order in which they were made."""
    filled = 0
    for row in range(len(rank)):
        at = rank[row]
        starts[row] = filled
        for n in range(row_ends[at - 1] if at else 0, row_ends[at]):
            sorted_columns[filled], sorted_values[filled] = columns[n], values[n]
            if len(slopes):
                for axis in range(3):
                    sorted_slopes[3 * filled + axis] = slopes[3 * n + axis]
            filled += 1


@inlined
def weigh(px, py, pz, size, room, sites, kind, outlines):
    """From sums to weights, at 0, and their gradients, at 1 to 3; the sum of the weights.

    A volume grows by the cut's area times the cut's motion; the cut's area grows at its outline.
    """
    total = 0.0
    for at in range(size):
        site = room.found[at]
        room.slots[site] = -1
        weight = max(room.sums[8 * at], 0.0) / 3.0
        if outlines:
            dx, dy, dz = px - sites[3 * site], py - sites[3 * site + 1], pz - sites[3 * site + 2]
            distance, area = np.sqrt(dx * dx + dy * dy + dz * dz), room.sums[8 * at + 1]
            if kind == SIBSON:
                room.sums[8 * at + 1] = (room.sums[8 * at + 2] - area * dx) / distance
                room.sums[8 * at + 2] = (room.sums[8 * at + 3] - area * dy) / distance
                room.sums[8 * at + 3] = (room.sums[8 * at + 4] - area * dz) / distance
            else:
                weight = max(area, 0.0) / distance
                pull = weight / (distance * distance)
                room.sums[8 * at + 1] = room.sums[8 * at + 5] / distance - pull * dx
                room.sums[8 * at + 2] = room.sums[8 * at + 6] / distance - pull * dy
                room.sums[8 * at + 3] = room.sums[8 * at + 7] / distance - pull * dz
        room.sums[8 * at] = weight
        total += weight
    return total


@inlined
def reproduced(px, py, pz, size, room, total, sites, on_site):
    """Whether the weights' mean of the sites is the point, which is not itself a site: they are all there."""
    x, y, z, spread, least = 0.0, 0.0, 0.0, 0.0, np.inf
    for at in range(size):
        site, weight = 3 * room.found[at], room.sums[8 * at]
        dx, dy, dz = sites[site] - px, sites[site + 1] - py, sites[site + 2] - pz
        x, y, z = x + weight * dx, y + weight * dy, z + weight * dz
        spread += weight * (abs(dx) + abs(dy) + abs(dz))
        least = min(least, dx * dx + dy * dy + dz * dz)
    return total > 0.0 and least > on_site * on_site and abs(x) + abs(y) + abs(z) <= 1e-12 * spread


@inlined
def only(site, room):
    """Weights of a point that is a site: how many they are, and their sum."""
    room.found[0], room.sums[0] = site, 1.0
    room.sums[1] = room.sums[2] = room.sums[3] = 0.0
    return 1, 1.0


@inlined
def write(size, room, total, limit, differentiate, filled, columns, values, slopes):
    """One row of coordinates, with gradients if they are wanted; where it ends."""
    x, y, z = 0.0, 0.0, 0.0
    if differentiate:
        for at in range(size):
            x, y, z = x + room.sums[8 * at + 1], y + room.sums[8 * at + 2], z + room.sums[8 * at + 3]
    for at in range(size):
        value = room.sums[8 * at] / total
        if value > 1e-17 and room.found[at] < limit:
            columns[filled], values[filled] = room.found[at], value
            if differentiate:
                slopes[3 * filled] = (room.sums[8 * at + 1] - value * x) / total
                slopes[3 * filled + 1] = (room.sums[8 * at + 2] - value * y) / total
                slopes[3 * filled + 2] = (room.sums[8 * at + 3] - value * z) / total
            filled += 1
    return filled
