"""Fewer vertices of a mesh, each one of the old: the dual of a Voronoi diagram on the surface (Du et al. 2003).

Vertices far apart are kept; each other vertex belongs to the kept one that is nearest along the edges, and where three
regions meet in a triangle there is a new one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidMesh, InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.numerics.meshes.adjacency import unique_edges
from pliant.numerics.meshes.graphs import edge_graph, nearest_source
from pliant.numerics.ragged import Ragged
from pliant.shape.surface_samples import farthest


def decimated(mesh: PolygonMesh, count: int) -> tuple[PolygonMesh, NDArray[np.int64]]:
    """A mesh of at most ``count`` of the vertices, and which these are.

    Raises
    ------
    InvalidParameter
        Fewer than four vertices, or more than there are.
    InvalidMesh
        The mesh has no faces.
    """
    triangles, points = mesh.triangles, mesh.points
    if not len(triangles):
        raise InvalidMesh("a mesh without faces cannot be decimated: take the marginal of some of its points")
    if not 4 <= count <= len(points):
        raise InvalidParameter(f"the mesh has {len(points):,} vertices: it can be decimated to 4 of them at least")
    kept = np.sort(np.asarray(farthest(points, count, np.random.default_rng(0)), np.int64))
    _, source = nearest_source(edge_graph(points, unique_edges(Ragged.of(triangles))), kept)
    region = np.searchsorted(kept, np.maximum(source, 0))[triangles]
    whole = (source[triangles] >= 0).all(axis=1)
    whole &= (region[:, 0] != region[:, 1]) & (region[:, 1] != region[:, 2]) & (region[:, 2] != region[:, 0])
    faces = region[whole]
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    return PolygonMesh(points[kept], faces[np.sort(first)]), kept
