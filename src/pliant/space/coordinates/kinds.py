"""The kinds of coordinates, by name."""

from __future__ import annotations

import numpy as np

from pliant.mesh import PolygonMesh
from pliant.space.coordinates.base import Coordinates
from pliant.space.coordinates.green import Green
from pliant.space.coordinates.harmonic import Harmonic
from pliant.space.coordinates.maximum_entropy import MaximumEntropy
from pliant.space.coordinates.mean_value import MeanValue
from pliant.space.coordinates.refinement import refined
from pliant.space.coordinates.surface import CageSurface

KINDS: dict[str, type[Coordinates]] = {
    "mean_value": MeanValue,
    "green": Green,
    "harmonic": Harmonic,
    "maximum_entropy": MaximumEntropy,
    "quad_mean_value": MeanValue,
    "quad_green": Green,
}


def coordinates_of(name: str, mesh: PolygonMesh, levels: int) -> Coordinates:
    """Coordinates of a kind with respect to a cage."""
    kind = KINDS[name]
    if name in ("mean_value", "green", "maximum_entropy"):
        return kind(CageSurface(mesh.points, mesh.triangles))
    triangles, quads = _parts(mesh, quadrangles=name.startswith("quad_"))
    prolongation, fine = refined(len(mesh.points), triangles, quads, levels)
    return kind(CageSurface(np.asarray(prolongation @ mesh.points), fine), prolongation)


def _parts(mesh: PolygonMesh, *, quadrangles: bool) -> tuple[np.ndarray, np.ndarray]:
    """(t, 3) triangles and (q, 4) quadrangles of a mesh; larger polygons are cut into triangles."""
    whole = (mesh.faces.lengths == 4) & quadrangles
    corners = mesh.faces.offsets[:-1][whole, None] + np.arange(4)
    quads = mesh.faces.flat[corners].astype(np.int64)
    return mesh.triangles[~whole[mesh.triangle_faces]].astype(np.int64), quads
