"""How smoothly faces meet: angles between the normals on both sides of an edge."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.cad.kernel import kernel, parts_of

_PLACES = 7  # along an edge; not its ends, where other faces meet


def kinks(shape: Any) -> NDArray[np.float64]:
    """(e,) the largest angle between the normals of the faces at each edge, radians; zero where there is one face."""
    edges = parts_of(shape, "edge")
    normals: dict[int, list[NDArray[np.float64]]] = {hash(edge): [] for edge in edges}
    for face in parts_of(shape, "face"):
        for edge in parts_of(face, "edge"):
            if not kernel("BRep").BRep_Tool.Degenerated_s(edge):
                normals[hash(edge)].append(_normals(edge, face))
    return np.array([_largest(normals[hash(edge)]) for edge in edges])


def _normals(edge: Any, face: Any) -> NDArray[np.float64]:
    """(7, 3) unit normals of a face along an edge, outwards."""
    tool, gp = kernel("BRep").BRep_Tool, kernel("gp")
    first, last = tool.Range_s(edge, face)
    curve, surface = tool.CurveOnSurface_s(edge, face, 0.0, 1.0), tool.Surface_s(face)
    found = []
    for at in first + (last - first) * (np.arange(_PLACES) + 0.5) / _PLACES:
        place, point, u, v = curve.Value(at), gp.gp_Pnt(), gp.gp_Vec(), gp.gp_Vec()
        surface.D1(place.X(), place.Y(), point, u, v)
        normal = np.cross((u.X(), u.Y(), u.Z()), (v.X(), v.Y(), v.Z()))
        found.append(normal / (np.linalg.norm(normal) or 1.0))
    sign = -1.0 if face.Orientation() == kernel("TopAbs").TopAbs_REVERSED else 1.0
    return sign * np.array(found)


def _largest(sides: list[NDArray[np.float64]]) -> float:
    if len(sides) != 2:
        return 0.0
    one, two = sides
    across = np.linalg.norm(np.cross(one, two), axis=1)
    return float(np.arctan2(across, (one * two).sum(axis=1)).max())
