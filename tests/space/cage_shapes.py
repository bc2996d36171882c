"""Cages that the tests of coordinates share, and mean value coordinates in plain extended precision."""

from __future__ import annotations

import numpy as np

from pliant.mesh import PolygonMesh

CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
SIDES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def box() -> PolygonMesh:
    """A cube of six quadrangles, from -1 to 1."""
    return PolygonMesh(CUBE, SIDES)


def ball(levels: int = 1, roughness: float = 0.1, seed: int = 0) -> PolygonMesh:
    """A rough ball of triangles, of radius about one: 18, 66, 258 vertices."""
    points = np.vstack([np.eye(3), -np.eye(3)])
    faces = np.array([[i, j, k] for i in (0, 3) for j in (1, 4) for k in (2, 5)])
    volumes = np.linalg.det(points[faces])
    faces[volumes < 0] = faces[volumes < 0][:, ::-1]
    for _ in range(levels):
        edges, place = np.unique(
            np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1),
            axis=0,
            return_inverse=True,
        )
        middle = len(points) + place.reshape(-1, 3)
        points = np.vstack([points, points[edges].mean(axis=1)])
        corner = [np.stack([faces[:, i], middle[:, i], middle[:, i - 1]], axis=1) for i in range(3)]
        faces = np.vstack([*corner, middle])
        points /= np.linalg.norm(points, axis=1, keepdims=True)
    radii = 1 + roughness * np.random.default_rng(seed).uniform(-1, 1, len(points))
    return PolygonMesh(points * radii[:, None], faces)


def dented() -> PolygonMesh:
    """A ball whose top is pushed in: a bowl with a deep hollow."""
    mesh = ball(2, 0.0)
    points = mesh.points.copy()
    from_axis = np.linalg.norm(points[:, :2], axis=1)
    hollow = (points[:, 2] > 0) & (from_axis < 0.8)
    points[hollow, 2] -= 1.4 * (1 - from_axis[hollow] / 0.8)
    return mesh.with_points(points)


def plain_mean_values(cage: PolygonMesh, point) -> np.ndarray:
    """Weights of one point, in extended precision, triangle by triangle."""
    arms = (cage.points - point).astype(np.longdouble)
    weights = np.zeros(len(arms), np.longdouble)
    for triangle in cage.triangles:
        a = arms[triangle]
        normals = [np.cross(a[(i + 1) % 3], a[(i + 2) % 3]) for i in range(3)]
        sines = [np.sqrt((c * c).sum()) for c in normals]
        angles = [np.arctan2(sines[i], (a[(i + 1) % 3] * a[(i + 2) % 3]).sum()) for i in range(3)]
        mean = sum(angles[i] * normals[i] / sines[i] for i in range(3)) / 2
        for i in range(3):
            weights[triangle[i]] += (normals[i] * mean).sum() / (a[0] * normals[0]).sum()
    return weights / weights.sum()


def plain_green(cage: PolygonMesh, point) -> tuple[np.ndarray, np.ndarray]:
    """Weights of one point by quadrature: psi = integral of 1 / 4 pi r, phi = integral of its normal derivative."""
    nodes, shares = np.polynomial.legendre.leggauss(40)
    nodes, shares = (nodes + 1) / 2, shares / 2
    s, t = np.meshgrid(nodes, nodes, indexing="ij")
    u, v = s * (1 - t), s * t  # a square folded into a triangle
    weight = np.outer(shares, shares) * s
    phi, psi = np.zeros(len(cage.points)), np.zeros(len(cage.triangles))
    for number, triangle in enumerate(cage.triangles):
        a, b, c = cage.points[triangle]
        normal = np.cross(b - a, c - a)
        places = a + u[..., None] * (b - a) + v[..., None] * (c - a) - point
        r = np.linalg.norm(places, axis=-1)
        psi[number] = (weight / r).sum() * np.linalg.norm(normal) / (4 * np.pi)
        flux = weight * (places @ normal) / r**3 / (4 * np.pi)
        for k, part in enumerate((1 - u - v, u, v)):
            phi[triangle[k]] += (flux * part).sum()
    return phi, psi
