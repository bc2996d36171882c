"""Pushing a cage outwards until it encloses a mesh, every vertex and every face."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points, PolygonMesh
from pliant.numerics.coordinates.winding import winding_numbers
from pliant.numerics.meshes.closest_surface import TriangleSearch
from pliant.numerics.meshes.manifold import flat_triangles
from pliant.numerics.meshes.triangle_crossings import crossings

Floats = NDArray[np.float64]
Triangles = NDArray[np.integer]

_MORE = 1.05  # of a violation: how far its vertices go
_ROUNDS = 60


def push_out(points: Points, triangles: Triangles, mesh: PolygonMesh, clearance: float) -> tuple[Points, bool]:
    """Move a cage's vertices along their normals until it encloses a mesh.

    A vertex steps by 1.05 of the largest violation of its faces: how far points of the mesh stick out, or, where only
    faces cut through one another, part of the size of the mesh's.

    Parameters
    ----------
    points, triangles
        The cage.
    mesh
        What to enclose.
    clearance
        The least step, and what is added to each.

    Returns
    -------
    points
        Where the vertices are in the end.
    enclosed
        Whether nothing sticks out any more.
    """
    points, scale = points.copy(), mesh.diagonal
    sizes = longest_sides(mesh)
    for _ in range(_ROUNDS):
        violation = violations(points, triangles, mesh, sizes, clearance)
        if not violation.any():
            return points, True
        steps = np.zeros(len(points))
        np.maximum.at(steps, triangles.reshape(-1), np.repeat(violation, 3))
        points += np.minimum(_MORE * steps, 0.05 * scale)[:, None] * vertex_directions(points, triangles)
    return points, False


def vertex_directions(points: Points, triangles: Triangles) -> Floats:
    """(m, 3) unit normals at vertices, each triangle weighted by its angle there."""
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    result = np.zeros_like(points)
    for k in range(3):
        one, two = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        angle = np.arctan2(np.linalg.norm(np.cross(one, two), axis=1), np.einsum("ti,ti->t", one, two))
        np.add.at(result, triangles[:, k], angle[:, None] * normals)
    return np.asarray(result / np.maximum(np.linalg.norm(result, axis=1, keepdims=True), 1e-300))


def violations(points: Points, triangles: Triangles, mesh: PolygonMesh, sizes: Floats, clearance: float) -> Floats:
    """(t,) how far each face of the cage is from enclosing what is in front of it."""
    violation = np.zeros(len(triangles))
    outside = np.flatnonzero(winding_numbers(mesh.points, points, triangles) < 0.5)
    whole = np.delete(np.arange(len(triangles)), flat_triangles(points, triangles))
    if len(outside) and len(whole):
        found = TriangleSearch(points, triangles[whole]).query(mesh.points[outside])
        distance = np.linalg.norm(mesh.points[outside] - found.points, axis=1)
        np.maximum.at(violation, whole[found.triangles], distance + clearance)
    pairs = crossings(points, triangles, mesh.points, mesh.triangles)
    if len(pairs):
        np.maximum.at(violation, pairs[:, 0], np.clip(0.2 * sizes[pairs[:, 1]], clearance, 4 * clearance))
    return violation


def longest_sides(mesh: PolygonMesh) -> Floats:
    """(t,) how long the longest side of each triangle is."""
    corners = mesh.points[mesh.triangles]
    return np.asarray(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1, initial=0.0))
