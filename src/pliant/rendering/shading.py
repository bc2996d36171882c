"""A polygon mesh as the graphics card wants it: triangles that share nothing, each corner with its own normal."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import PolygonMesh
from pliant.numerics.meshes.triangulation import polygon_normals

FEATURE = np.cos(np.radians(40))  # polygons that meet at more than 40 degrees keep their edge


def corner_normals(mesh: PolygonMesh) -> NDArray[np.float64]:
    """(t, 3, 3) unit normals at the corners of ``mesh.triangles``.

    A corner's normal is the mean, weighted by area, of the polygons around its vertex whose normal is within the
    feature angle of its own polygon's. Seams of texture coordinates do not interrupt it.
    """
    area = polygon_normals(mesh.points, mesh.faces)
    length = np.linalg.norm(area, axis=1, keepdims=True)
    unit = np.divide(area, length, out=np.zeros_like(area), where=length > 0)
    corner, other = _corners_around_vertices(mesh)
    face = mesh.faces.row_of
    near = np.einsum("ij,ij->i", unit[face[corner]], unit[face[other]]) >= FEATURE
    weights = area[face[other[near]]]
    count = len(mesh.faces.flat)
    sums = np.stack([np.bincount(corner[near], weights[:, axis], minlength=count) for axis in range(3)], axis=1)
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    normals = np.divide(sums, length, out=np.tile([0.0, 0.0, 1.0], (count, 1)), where=length > 0)
    return np.asarray(normals[mesh.triangle_corners])


def _corners_around_vertices(mesh: PolygonMesh) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """All ordered pairs of corners that sit at the same vertex, a corner with itself included."""
    vertex = mesh.faces.flat
    by_vertex = np.argsort(vertex, kind="stable")
    valence = np.bincount(vertex, minlength=len(mesh.points))
    first = np.cumsum(valence) - valence
    repeat = valence[vertex[by_vertex]]
    corner = np.repeat(by_vertex, repeat)
    within = np.arange(len(corner)) - np.repeat(np.cumsum(repeat) - repeat, repeat)
    return corner, by_vertex[np.repeat(first[vertex[by_vertex]], repeat) + within]
