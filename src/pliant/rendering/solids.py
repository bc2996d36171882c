"""Meshes, lines, balls and points, added to a plotter."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points, PolygonMesh
from pliant.numerics.ragged import Ragged
from pliant.rendering.coats import Coat
from pliant.rendering.palette import CLAY, CONTROL, LIGHT
from pliant.rendering.quantities import Quantity, painted
from pliant.rendering.shading import corner_normals
from pliant.rendering.window import import_pyvista

SHINE = {"ambient": 0.26, "diffuse": 0.84, "specular": 0.14, "specular_power": 24}
LEGIBLE = {"ambient": 0.38, "diffuse": 0.74, "specular": 0.05}  # near enough to the colour bar to be read
GLOSS = {"ambient": 0.25, "diffuse": 0.8, "specular": 0.35, "specular_power": 30}


def add_surface(drawing: Any, mesh: PolygonMesh, coat: Coat) -> None:
    """Draw the faces."""
    normals = corner_normals(mesh)
    bare = np.ones(len(mesh.triangles), bool)
    for worn, picture in coat.pictures:
        _add_triangles(drawing, mesh, worn, normals, coat, picture)
        bare &= ~worn
    _add_triangles(drawing, mesh, bare, normals, coat, None)


def _add_triangles(
    drawing: Any,
    mesh: PolygonMesh,
    which: NDArray[np.bool_],
    normals: NDArray[np.float64],
    coat: Coat,
    picture: NDArray[np.uint8] | None,
) -> None:
    """Draw some triangles; they share no points, so that every corner keeps its own normal, colour and place."""
    if not which.any():
        return
    pyvista = import_pyvista()
    surface = pyvista.PolyData(mesh.points[mesh.triangles[which].reshape(-1)], faces=_apart(3 * int(which.sum()), 3))
    surface.point_data.active_normals = normals[which].reshape(-1, 3)
    if picture is None:
        surface["colors"] = coat.colors[which].reshape(-1, 3)
        style: dict[str, Any] = {"scalars": "colors", "rgb": True}
    else:
        assert mesh.uvs is not None
        surface.active_texture_coordinates = mesh.uvs.per_corner[mesh.triangle_corners[which].reshape(-1), :2]
        style = {"texture": pyvista.numpy_to_texture(picture), "color": "white"}
    actor = drawing.add_mesh(surface, smooth_shading=False, **style, **(LEGIBLE if coat.legible else SHINE))
    actor.prop.interpolation = "Phong"


def add_bare(drawing: Any, mesh: PolygonMesh, paint: Quantity | None, size: float) -> None:
    """Draw what is not a face: polylines, and the points of a mesh that has nothing else."""
    colors = None if paint is None or paint.on_faces else painted(paint)
    if mesh.lines is not None and len(mesh.lines):
        add_lines(drawing, mesh.points, mesh.lines, 0.0012 * size, CLAY if colors is None else colors)
    elif not len(mesh.faces):
        pixels = float(np.clip(40_000 / len(mesh.points), 4, 16))
        style: dict[str, Any] = {"color": CONTROL} if colors is None else {"scalars": colors, "rgb": True}
        drawing.add_mesh(mesh.points, style="points", point_size=pixels, render_points_as_spheres=True, **style)


def add_edges(drawing: Any, mesh: PolygonMesh, size: float) -> None:
    """Draw the polygons' edges."""
    if len(mesh.edges):
        add_lines(drawing, mesh.points, Ragged.of(mesh.edges), 0.0006 * size, LIGHT.ink)


def add_lines(drawing: Any, points: Points, lines: Ragged, radius: float, color: Any) -> None:
    """Draw polylines as tubes that no light changes, in one colour or in (n, 3) colours."""
    pyvista = import_pyvista()
    path = pyvista.PolyData()
    path.points = points
    path.lines = np.insert(lines.flat.astype(np.int64), lines.offsets[:-1], lines.lengths)
    style: dict[str, Any] = {"color": color}
    if isinstance(color, np.ndarray):
        path["colors"] = color
        style = {"scalars": "colors", "rgb": True}
    drawing.add_mesh(path.tube(radius=radius, n_sides=10, capping=True), lighting=False, **style)


def add_balls(drawing: Any, points: Points, radius: float, color: Any) -> None:
    """Draw points as small spheres."""
    if not len(points):
        return
    pyvista = import_pyvista()
    ball = pyvista.Sphere(radius=radius, theta_resolution=24, phi_resolution=16)
    glyphs = pyvista.PolyData(points).glyph(geom=ball, scale=False, orient=False)
    drawing.add_mesh(glyphs, color=color, smooth_shading=True, **GLOSS)


def _apart(count: int, corners: int) -> NDArray[np.int64]:
    """Polygons that share nothing, as VTK keeps them: each row preceded by its length."""
    rows = np.arange(count, dtype=np.int64).reshape(-1, corners)
    return np.insert(rows, 0, corners, axis=1).reshape(-1)
