"""Which feature each face of a mesh belongs to."""

from __future__ import annotations

import numpy as np

from pliant.face.features import GROUPS, group_of_sites, sites
from pliant.mesh import FaceLabels, Points, PolygonMesh


def groups_of_faces(landmarks: Points, mesh: PolygonMesh) -> FaceLabels:
    """The group of each triangle: that of the nearest of (468, 3) landmarks that handles move."""
    from scipy.spatial import cKDTree

    chosen = sites()[0]
    nearest = cKDTree(landmarks[chosen]).query(mesh.points[mesh.triangles].mean(axis=1))[1]
    return FaceLabels(tuple(GROUPS), group_of_sites().argmax(axis=1)[nearest].astype(np.int32))
