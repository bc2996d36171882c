"""The volume that a closed mesh encloses."""

from __future__ import annotations

import numpy as np

from pliant.errors import InvalidMesh
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.meshes.adjacency import half_edges
from pliant.numerics.meshes.triangulation import polygon_normals


def volume(mesh: PolygonMesh) -> float:
    """The signed volume of a closed mesh, positive where its faces look outwards.

    By the divergence theorem: a sixth of the sum, over the polygons, of centroid · Newell area vector, about the
    middle of the box, where it loses the fewest digits. Exact for planar polygons of any shape; a bent one counts
    as the fan about the mean of its corners, so that the volume does not depend on how anyone would cut it, and is
    linear in each of x, y and z alone.

    Parameters
    ----------
    mesh
        A mesh whose every edge is used as often one way as the other.

    Returns
    -------
    float
        In the cube of the mesh's unit; 0 for a mesh without faces.

    Raises
    ------
    InvalidMesh
        The mesh is open, or neighbouring faces disagree about the outside; the edges are counted.
    """
    _require_closed(mesh)
    return unchecked_volume(mesh)


def volume_gradient(mesh: PolygonMesh) -> Points:
    """(n, 3) how :func:`volume` changes with the points of a closed mesh.

    A step along one axis alone, of however many points, changes the volume by exactly the gradient times the step.

    Parameters
    ----------
    mesh
        Closed; any polygons.

    Raises
    ------
    InvalidMesh
        As :func:`volume`.
    """
    _require_closed(mesh)
    return unchecked_gradient(mesh)


def unchecked_volume(mesh: PolygonMesh) -> float:
    """As :func:`volume`, of a mesh that is known to be closed."""
    centroids, area_vectors = _polygons(mesh)
    return float(np.einsum("ij,ij->i", centroids, area_vectors).sum() / 6)


def unchecked_gradient(mesh: PolygonMesh) -> Points:
    """As :func:`volume_gradient`, of a mesh that is known to be closed."""
    centroids, area_vectors = _polygons(mesh)
    filled = mesh.faces.lengths > 0
    sides = mesh.faces.lengths[filled]
    polygon = np.repeat(np.arange(len(sides)), sides)  # of each corner
    points = mesh.points - mesh.center
    edges = half_edges(mesh.faces)
    here, following = edges[:, 0], edges[:, 1]
    gradient = np.zeros_like(points)
    np.add.at(
        gradient, here, area_vectors[polygon] / sides[polygon, None] + np.cross(points[following], centroids[polygon])
    )
    np.add.at(gradient, following, np.cross(centroids[polygon], points[here]))
    return gradient / 6


def _polygons(mesh: PolygonMesh) -> tuple[Points, Points]:
    """Means of the corners and Newell area vectors, (f, 3) each, of polygons with corners; about the box's middle."""
    filled = mesh.faces.lengths > 0
    if not filled.any():
        return np.empty((0, 3)), np.empty((0, 3))
    points = mesh.points - mesh.center
    starts = mesh.faces.offsets[:-1][filled]
    centroids = np.add.reduceat(points[mesh.faces.flat], starts, axis=0) / mesh.faces.lengths[filled, None]
    return centroids, polygon_normals(points, mesh.faces)[filled]


def _require_closed(mesh: PolygonMesh) -> None:
    """Every edge must be used as often one way as the other: the faces' boundary is then nothing."""
    once, disagree = _unbalanced_edges(mesh)
    if once:
        raise InvalidMesh(f"the mesh is open: {once} boundary edges; close its holes, an open mesh has no volume")
    if disagree:
        raise InvalidMesh(f"neighbouring faces disagree about the outside along {disagree} edges: orient the faces")


def _unbalanced_edges(mesh: PolygonMesh) -> tuple[int, int]:
    """How many edges one face alone uses, and how many others are used one way more often than the other."""
    edges = half_edges(mesh.faces)
    edges = edges[edges[:, 0] != edges[:, 1]]
    sign = np.where(edges[:, 0] < edges[:, 1], 1, -1)
    low, high = edges.min(axis=1).astype(np.int64), edges.max(axis=1)
    _, edge, count = np.unique(low * len(mesh.points) + high, return_inverse=True, return_counts=True)
    balance = np.bincount(edge.reshape(-1), weights=sign, minlength=len(count))
    return int((count == 1).sum()), int(((count > 1) & (balance != 0)).sum())
