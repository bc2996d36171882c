"""What differs between a mesh and what came back from a file, and whether the writer had said so."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.io.mesh_formats.colors import as_float, is_color
from pliant.io.report import LossReport
from pliant.mesh import CornerValues, FaceLabels, PolygonMesh

SINGLE = 1e-6  # of the largest coordinate: what single precision may take
_SAID = {  # the words with which a loss of each kind is declared
    "points": r"rounded to 32 bits|rounded to",
    "vertices": r"share vertices|vertices are added|unused vertices",
    "faces": r"are cut into|fewer than three|points alone|cut into triangles",
    "order": r"order|material",
    "uvs": r"texture coordinates|points alone",
    "normals": r"normals|points alone",
    "groups": r"groups",
    "objects": r"objects",
    "materials": r"materials",
    "lines": r"lines",
    "cells": r"cells",
    "colors": r"colou?rs",
}


@dataclass(frozen=True)
class Corners:
    """The faces of a mesh as a file may hold them: as they are, or as the triangles that they are cut into.

    Parameters
    ----------
    flat
        (c,) vertices, one face after another.
    lengths
        (f,) corners of each face.
    corner, face
        (c,) and (f,) where each corner and face was in the mesh.
    """

    flat: NDArray[np.int64]
    lengths: NDArray[np.int64]
    corner: NDArray[np.int64]
    face: NDArray[np.int64]


def as_is(mesh: PolygonMesh) -> Corners:
    """The faces as they are."""
    count = len(mesh.faces.flat)
    return Corners(mesh.faces.flat.astype(int), mesh.faces.lengths, np.arange(count), np.arange(len(mesh.faces)))


def cut(mesh: PolygonMesh) -> Corners:
    """The faces as triangles."""
    corners = mesh.triangle_corners.reshape(-1).astype(int)
    count = len(mesh.triangles)
    return Corners(mesh.faces.flat[corners].astype(int), np.full(count, 3), corners, mesh.triangle_faces)


def undeclared(before: PolygonMesh, after: PolygonMesh, report: LossReport) -> list[str]:
    """What differs and was not said."""
    said = "\n".join([*report.losses, *report.notes])
    return [f"{name}: {what}" for name, what in differences(before, after).items() if not _declared(name, said)]


def _declared(name: str, said: str) -> bool:
    if name.startswith("attribute"):
        return repr(name.partition(" ")[2]) in said
    return re.search(_SAID[name], said) is not None


def differences(before: PolygonMesh, after: PolygonMesh) -> dict[str, str]:
    """What differs, by kind."""
    found = _points(before, after)
    shape = as_is(before)
    if not np.array_equal(shape.lengths, after.faces.lengths) and (after.faces.lengths == 3).all():
        found["faces"] = f"{len(before.faces)} faces became {len(after.faces)} triangles"
        shape = cut(before)
    if not np.array_equal(shape.lengths, after.faces.lengths):
        found["faces"] = f"{len(before.faces)} faces became {len(after.faces)}"
        return {**found, **_aside(before, after)}
    one, two = before.points[shape.flat], after.points[after.faces.flat]
    if not _near(one, two):
        found["order"] = "the corners of the faces are other ones"
        return {**found, **_aside(before, after)}
    shared = after.vertex_attributes.get("normals")
    normals = after.normals if after.normals is not None or shared is None else shared[after.faces.flat]
    for name, values in (("uvs", after.uvs), ("normals", normals)):
        if not _same_corners(getattr(before, name), values, shape):
            found[name] = "values at corners differ"
    for name in ("groups", "objects", "materials"):
        if not _same_labels(getattr(before, name), getattr(after, name), shape):
            found[name] = "faces have other names"
    for name, values in before.face_attributes.items():
        there = after.face_attributes.get(name)
        if there is None or not _near(values[shape.face], there):
            found[_attribute(name)] = "values of faces differ"
    return {**found, **_aside(before, after)}


def _points(before: PolygonMesh, after: PolygonMesh) -> dict[str, str]:
    if len(before.points) != len(after.points):
        return {"vertices": f"{len(before.points)} became {len(after.points)}"}
    if np.array_equal(before.points, after.points):
        return {}
    if _near(before.points, after.points):
        return {"points": f"by up to {np.abs(before.points - after.points).max():.2g}"}
    return {"vertices": "they are elsewhere, or in another order"}


def _aside(before: PolygonMesh, after: PolygonMesh) -> dict[str, str]:
    """Lines, cells and what vertices carry; the latter only where the vertices are the same."""
    found = {}
    lines = [] if before.lines is None else [row.tolist() for row in before.lines]
    if lines != ([] if after.lines is None else [row.tolist() for row in after.lines]) and len(before.points) == len(
        after.points
    ):
        found["lines"] = "they differ"
    kinds = set(before.cells) | set(after.cells)
    if any(not np.array_equal(before.cells.get(kind, ()), after.cells.get(kind, ())) for kind in kinds):
        found["cells"] = "they differ"
    for name, values in before.vertex_attributes.items():
        there = after.vertex_attributes.get(name)
        alike = len(before.points) == len(after.points)
        if alike and name == "normals" and there is None and after.normals is not None:
            values, there = values[after.faces.flat], after.normals.per_corner  # the same, kept at corners
        if name == "colors" and there is not None and is_color(values):
            values, there = as_float(values), as_float(there)
        if alike and (there is None or not _near(values, there)):
            found[_attribute(name)] = "values of vertices differ"
    return found


def _attribute(name: str) -> str:
    return name if name in ("colors", "normals") else f"attribute {name}"


def _same_corners(
    before: CornerValues | None, after: CornerValues | NDArray[np.float64] | None, shape: Corners
) -> bool:
    if before is None:
        return True
    given = before.per_corner[shape.corner]
    if after is None:
        return bool(np.isnan(given).all())
    there = after if isinstance(after, np.ndarray) else after.per_corner
    if given.shape[1] == 3 and there.shape[1] == 2 and not np.nan_to_num(given[:, 2]).any():
        given = given[:, :2]  # nothing is lost with a third coordinate that is nothing
    return given.shape == there.shape and _near(given, there)


def _same_labels(before: FaceLabels | None, after: FaceLabels | None, shape: Corners) -> bool:
    if before is None:
        return True
    given = _names(before)[shape.face]
    return after is not None and bool((given == _names(after)).all()) if after is not None else not given.any()


def _names(labels: FaceLabels) -> NDArray[np.str_]:
    return np.array([*labels.names, ""])[labels.indices]


def _near(one: NDArray[np.generic], two: NDArray[np.generic]) -> bool:
    """Whether values are the same but for single precision."""
    first, second = np.asarray(one, np.float64), np.asarray(two, np.float64)
    if first.size != second.size:
        return False
    first, second = first.reshape(-1), second.reshape(-1)
    size = np.nanmax(np.abs(first), initial=0.0)
    return bool(np.allclose(first, second, rtol=0, atol=SINGLE * size, equal_nan=True))
