"""The area of a surface, and how it changes with the points: what friction, heat and paint act on."""

from __future__ import annotations

import numpy as np

from pliant.mesh import Points, PolygonMesh


def area(mesh: PolygonMesh) -> float:
    """The area of a mesh, in the square of its unit: the sum over ``mesh.triangles``, into which polygons are cut.

    Parameters
    ----------
    mesh
        Any mesh, open or closed; one without faces has area 0.
    """
    return float(np.linalg.norm(_area_vectors(mesh), axis=1).sum())


def area_gradient(mesh: PolygonMesh) -> Points:
    """(n, 3) how :func:`area` changes with the points.

    The area of a triangle with unit normal n grows with a corner as n × (the opposite edge) / 2 does. Triangles without
    area, where there is no derivative, count as zero. On a closed smooth surface the gradient is twice the mean
    curvature normal, integrated around each vertex (Meyer, Desbrun, Schröder & Barr 2003, eq. 8).

    Parameters
    ----------
    mesh
        Any mesh, open or closed.
    """
    vectors = _area_vectors(mesh)
    sizes = np.linalg.norm(vectors, axis=1, keepdims=True)
    normals = np.divide(vectors, sizes, out=np.zeros_like(vectors), where=sizes > 0)
    corners = mesh.points[mesh.triangles]
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    gradient = np.zeros_like(mesh.points)
    np.add.at(gradient, mesh.triangles, np.cross(normals[:, None], opposite) / 2)
    return gradient


def _area_vectors(mesh: PolygonMesh) -> Points:
    """(t, 3) normals of the triangles, as long as these are large."""
    a, b, c = mesh.points[mesh.triangles.T]
    vectors: Points = np.cross(b - a, c - a) / 2
    return vectors
