"""Shapes for the tests of surface deformers, made on the spot."""

from __future__ import annotations

import numpy as np

from pliant.mesh import PolygonMesh


def tube(
    rings: int = 24, around: int = 12, *, bumps: float = 0.0, radius: float = 0.4, length: float = 4.0
) -> PolygonMesh:
    """A closed tube along z with round ends, its triangles regular."""
    z = np.linspace(0, 1, rings)
    width = radius * np.sqrt(np.clip(1 - np.clip(1 - 2 * np.minimum(z, 1 - z) * length / radius / 2, 0, 1) ** 2, 0, 1))
    angle = np.linspace(0, 2 * np.pi, around, endpoint=False)
    width = np.maximum(width, 0.3 * radius)[:, None] * (1 + bumps * np.cos(3 * angle) * np.sin(9 * z)[:, None])
    points = np.stack(
        [width * np.cos(angle), width * np.sin(angle), np.broadcast_to(length * z[:, None], width.shape)], axis=-1
    ).reshape(-1, 3)
    faces = []
    for r in range(rings - 1):
        for s in range(around):
            a, b = r * around + s, r * around + (s + 1) % around
            faces += [[a, b, b + around], [a, b + around, a + around]]
    bottom, top, last = len(points), len(points) + 1, (rings - 1) * around
    for s in range(around):
        faces += [[bottom, (s + 1) % around, s], [top, last + s, last + (s + 1) % around]]
    points = np.vstack([points, [[0, 0, -0.05 * radius]], [[0, 0, length + 0.05 * radius]]])
    return PolygonMesh(points, faces)


def sheet(nx: int = 9, ny: int = 7) -> PolygonMesh:
    """A flat rectangle of right triangles in the plane z = 0."""
    x, y = np.meshgrid(np.arange(nx), np.arange(ny), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(nx * ny)]).astype(float)
    at = (x * ny + y)[:-1, :-1].ravel()
    faces = np.vstack([np.column_stack([at, at + ny, at + ny + 1]), np.column_stack([at, at + ny + 1, at + 1])])
    return PolygonMesh(points, faces)


def two_legs() -> PolygonMesh:
    """Two separate tubes side by side: two components."""
    one, two = tube(), tube(rings=18)
    points = np.vstack([one.points, two.points + [3.0, 0, 0]])
    return PolygonMesh(points, np.vstack([one.triangles, two.triangles + len(one.points)]))


def rotation(vector) -> np.ndarray:
    """(3, 3) by Rodrigues' formula, written anew."""
    vector = np.asarray(vector, float)
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k
