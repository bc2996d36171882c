"""Kernels for closest points on triangles (Ericson 2005, section 5.1.5), in a tree of boxes, and for normals."""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel


@inlined
def _dot(ax, ay, az, bx, by, bz):
    return ax * bx + ay * by + az * bz


@inlined
def _weights(corners, t, x, y, z):
    """Barycentric weights (v, w) of the closest point, for the second and third corner."""
    ax, ay, az = corners[t, 0, 0], corners[t, 0, 1], corners[t, 0, 2]
    ux, uy, uz = corners[t, 1, 0] - ax, corners[t, 1, 1] - ay, corners[t, 1, 2] - az
    vx, vy, vz = corners[t, 2, 0] - ax, corners[t, 2, 1] - ay, corners[t, 2, 2] - az
    px, py, pz = x - ax, y - ay, z - az
    d1, d2 = _dot(ux, uy, uz, px, py, pz), _dot(vx, vy, vz, px, py, pz)
    uu, uv, vv = _dot(ux, uy, uz, ux, uy, uz), _dot(ux, uy, uz, vx, vy, vz), _dot(vx, vy, vz, vx, vy, vz)
    d3, d4, d5, d6 = d1 - uu, d2 - uv, d1 - uv, d2 - vv
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    if d1 <= 0.0 and d2 <= 0.0:
        return 0.0, 0.0
    if d3 >= 0.0 and d4 <= d3:
        return 1.0, 0.0
    if d6 >= 0.0 and d5 <= d6:
        return 0.0, 1.0
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        return d1 / (d1 - d3), 0.0
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        return 0.0, d2 / (d2 - d6)
    if va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return 1.0 - w, w
    scale = 1.0 / (va + vb + vc)
    return vb * scale, vc * scale


@inlined
def _square(corners, t, v, w, x, y, z):
    """The squared distance from a point to that with weights v, w on a triangle."""
    u = 1.0 - v - w
    dx = x - u * corners[t, 0, 0] - v * corners[t, 1, 0] - w * corners[t, 2, 0]
    dy = y - u * corners[t, 0, 1] - v * corners[t, 1, 1] - w * corners[t, 2, 1]
    dz = z - u * corners[t, 0, 2] - v * corners[t, 1, 2] - w * corners[t, 2, 2]
    return dx * dx + dy * dy + dz * dz


@inlined
def _outside(boxes, node, x, y, z):
    """The squared distance from a point to a box."""
    dx = max(boxes[node, 0] - x, x - boxes[node, 3], 0.0)
    dy = max(boxes[node, 1] - y, y - boxes[node, 4], 0.0)
    dz = max(boxes[node, 2] - z, z - boxes[node, 5], 0.0)
    return dx * dx + dy * dy + dz * dz


@kernel
def nearest_in(points, start, stop, corners, bounds, boxes, chosen, weights, distance):
    """For points [start, stop) of (m, 3) the nearest of the triangles (t, 3, 3), and its squared distance.

    ``boxes`` (2 l, 6) is a binary tree, node 1 its root, 2 i and 2 i + 1 below i; leaf i < l, node l + i, holds the
    triangles from bounds[i] to bounds[i + 1]. A point begins with the triangle that ``chosen`` names, or where that is
    -1 with the one of the point before: near, as a rule.
    """
    leaves = len(bounds) - 1
    nodes, squares = np.empty(64, np.int64), np.empty(64)
    best = 0
    for i in range(start, stop):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        if chosen[i] >= 0:
            best = chosen[i]
        best_v, best_w = _weights(corners, best, x, y, z)
        least = _square(corners, best, best_v, best_w, x, y, z)
        nodes[0], squares[0], waiting = 1, 0.0, 1
        while waiting > 0:
            waiting -= 1
            node = nodes[waiting]
            if squares[waiting] >= least:
                continue
            while node < leaves:
                left, right = _outside(boxes, 2 * node, x, y, z), _outside(boxes, 2 * node + 1, x, y, z)
                near = 2 * node if left <= right else 2 * node + 1
                if max(left, right) < least:
                    nodes[waiting], squares[waiting] = 4 * node + 1 - near, max(left, right)
                    waiting += 1
                node = near
                if min(left, right) >= least:
                    break
            if node < leaves or _outside(boxes, node, x, y, z) >= least:
                continue
            for t in range(bounds[node - leaves], bounds[node - leaves + 1]):
                v, w = _weights(corners, t, x, y, z)
                d = _square(corners, t, v, w, x, y, z)
                if d < least:
                    least, best, best_v, best_w = d, t, v, w
        distance[i], chosen[i] = least, best
        weights[i, 0], weights[i, 1], weights[i, 2] = 1.0 - best_v - best_w, best_v, best_w


@kernel
def add_normals(points, triangles, sums):
    """Add to the (n, 3) sums of each corner its triangle's normal, twice the area long."""
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ux, uy, uz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
        vx, vy, vz = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1], points[c, 2] - points[a, 2]
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        for i in (a, b, c):
            sums[i, 0] += nx
            sums[i, 1] += ny
            sums[i, 2] += nz
