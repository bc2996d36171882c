"""The kernel for closest points on triangles (Ericson 2005, section 5.1.5)."""

from __future__ import annotations

from pliant.numerics.compiling import inlined, kernel


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


@kernel
def nearest_of(points, start, stop, corners, candidates, chosen, weights, distance):
    """For points [start, stop) of (m, 3) the nearest of their (m, k) candidate triangles (t, 3, 3)."""
    for i in range(start, stop):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        distance[i] = 1e300
        for j in range(candidates.shape[1]):
            t = candidates[i, j]
            v, w = _weights(corners, t, x, y, z)
            u = 1.0 - v - w
            dx = x - u * corners[t, 0, 0] - v * corners[t, 1, 0] - w * corners[t, 2, 0]
            dy = y - u * corners[t, 0, 1] - v * corners[t, 1, 1] - w * corners[t, 2, 1]
            dz = z - u * corners[t, 0, 2] - v * corners[t, 1, 2] - w * corners[t, 2, 2]
            d = dx * dx + dy * dy + dz * dz
            if d < distance[i]:
                distance[i], chosen[i] = d, t
                weights[i, 0], weights[i, 1], weights[i, 2] = u, v, w
