"""One picture of a shape, its deformation, and what deforms it."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Deformer, MeshDeformer, SpaceDeformer
from pliant.errors import InvalidMesh, InvalidParameter, UnsupportedFormat
from pliant.field.grids import checked_spacing, field_grid
from pliant.field.vectors import arrows
from pliant.io.files import replacing
from pliant.mesh import Points, PolygonMesh
from pliant.rendering.camera import ANGLE, frame, view_axes
from pliant.rendering.coats import coat_of_its_own, coat_of_numbers
from pliant.rendering.fields import add_arrows, add_grid, add_lattice
from pliant.rendering.legend import WIDTH, with_legend
from pliant.rendering.palette import THEMES, Theme
from pliant.rendering.quantities import quantity
from pliant.rendering.solids import add_bare, add_edges, add_surface
from pliant.rendering.window import import_pyvista, plotter

SHOWN = ("mesh", "edges", "lattice", "grid", "arrows")
FORMATS = (".png", ".jpg", ".jpeg", ".webp", ".tif", ".tiff")
FINER = 2  # drawn this many times larger, then averaged: smooth edges wherever they come from
Image = NDArray[np.uint8]


def render(
    mesh: PolygonMesh,
    deformer: Deformer | None = None,
    path: Path | str | None = None,
    *,
    show: Collection[str] = ("mesh", "lattice"),
    color: str | ArrayLike | None = None,
    limits: tuple[float, float] | None = None,
    unit: str = "",
    legend: bool = True,
    texture: Path | str | None = None,
    view: str | ArrayLike = "iso",
    up: str = "z",
    size: tuple[int, int] = (1600, 1200),
    background: str = "light",
    spacing: float | None = None,
) -> Path | Image:
    """Draw a mesh, deformed, together with what deforms it. No display is needed.

    Parameters
    ----------
    mesh
        The mesh at rest.
    deformer
        What deforms it; None = nothing.
    path
        A ``.png``, ``.jpg``, ``.webp`` or ``.tif`` file; None = return the picture.
    show
        Any of ``"mesh"``, ``"edges"`` (of its polygons), ``"lattice"`` (control points), ``"grid"`` (a regular grid on
        three planes, warped) and ``"arrows"`` (displacements). What a deformer does not have is left out.
    color
        None = the mesh's own texture, or clay. ``"texture"`` = its texture, or a checkerboard;
        ``"displacement"``, ``"x"``, ``"y"``, ``"z"``, ``"volume ratio"``, an attribute's name, or (n,) numbers a vertex
        or (f,) a face give a colour bar.
    limits
        The ends of the colour bar; None = those of the values, about one for the volume ratio.
    unit
        The unit that the colour bar names.
    legend
        Whether there is a colour bar.
    texture
        An image to wear instead of the mesh's own.
    view
        ``"iso"``, ``"front"``, ``"back"``, ``"left"``, ``"right"``, ``"top"``, ``"bottom"``, or the direction (3,)
        in which the viewer stands.
    up
        The axis that points up, ``"z"`` or ``"y"``.
    size
        Width and height in pixels.
    background
        ``"light"``, ``"dark"`` or ``"transparent"``.
    spacing
        Distance of grid lines, arrows being half as far again apart; None = a sixteenth of the diagonal.

    Returns
    -------
    Path or ndarray
        The file written, or (h, w, 3) uint8 colours, (h, w, 4) where transparent.

    Raises
    ------
    InvalidMesh
        There is nothing to draw.
    InvalidParameter
        An unknown word, or colours of another length.
    UnsupportedFormat
        The file's suffix is no picture's, or cannot be transparent.
    MissingExtra, NoGraphics
        PyVista, or a driver to draw with, is not installed.
    """
    _check(mesh, show, size, background, path)
    apart = _size_of(mesh) / 16 if spacing is None else float(checked_spacing(spacing).min())
    axes, theme = view_axes(view, up), THEMES[background]
    after = mesh if deformer is None else deformer(mesh)
    paint = None
    if color is None or (isinstance(color, str) and color == "texture"):
        coat = coat_of_its_own(after, texture, checkered=color is not None)
    else:
        paint = quantity(color, mesh, after, deformer, limits, theme.sequence)
        coat = coat_of_numbers(after, paint)
    with plotter((FINER * size[0], FINER * size[1])) as drawing:
        if "mesh" in show:
            add_surface(drawing, after, coat)
            add_bare(drawing, after, paint, _size_of(mesh))
        if "edges" in show:
            add_edges(drawing, after, _size_of(mesh))
        around = _draw_deformer(drawing, mesh, deformer, show, theme, apart)
        seen = np.vstack([after.points, *around])
        _place_camera(drawing, seen, axes, size[0] / size[1], WIDTH if paint and legend else 0.0)
        _light(drawing, float(np.linalg.norm(np.ptp(seen, axis=0))) or 1.0)
        picture = _transparent(drawing) if background == "transparent" else _shot(drawing, theme.background)
    if paint is not None and legend:
        picture = with_legend(picture, paint, unit, theme)
    return picture if path is None else _saved(picture, Path(path))


def _draw_deformer(
    drawing: Any,
    mesh: PolygonMesh,
    deformer: Deformer | None,
    show: Collection[str],
    theme: Theme,
    spacing: float,
) -> list[Points]:
    """Put what deforms the mesh into the picture; the points that must be seen."""
    seen = []
    if deformer is not None and not isinstance(deformer, MeshDeformer) and "lattice" in show:
        seen.append(add_lattice(drawing, deformer, _size_of(mesh), theme))
    if not isinstance(deformer, SpaceDeformer):
        return seen
    low, high = mesh.bounds
    if "grid" in show:
        planes = {axis: float(middle) for axis, middle in zip("xyz", mesh.center, strict=True)}
        grid = field_grid(deformer, (low - spacing, high + spacing), spacing, planes=planes)
        seen.append(add_grid(drawing, grid, _size_of(mesh), theme))
    if "arrows" in show:
        apart = 1.5 * spacing
        seen.append(add_arrows(drawing, arrows(deformer, mesh.bounds, apart), apart, theme))
    return seen


def _size_of(mesh: PolygonMesh) -> float:
    """What the thickness of things is measured against: the diagonal, or 1 for a single point."""
    return mesh.diagonal or 1.0


def _place_camera(drawing: Any, seen: Points, axes: Points, aspect: float, right: float) -> None:
    camera = frame(seen, axes, aspect, right=right)
    drawing.camera_position = [camera.position, camera.focus, camera.up]
    drawing.camera.view_angle = np.degrees(ANGLE)
    drawing.camera.SetWindowCenter(right, 0.0)
    drawing.reset_camera_clipping_range()


def _light(drawing: Any, size: float, samples: int = 96) -> None:
    """Key from the upper left, fill from the right, rim from behind; hollows are darker, by so many samples."""
    pyvista = import_pyvista()
    for position, strength, tint in (
        ((-0.7, 0.9, 1.0), 0.86, (1.0, 0.99, 0.97)),
        ((1.0, 0.1, 0.9), 0.42, (0.96, 0.98, 1.0)),
        ((0.5, 0.9, -0.8), 0.30, (1.0, 1.0, 1.0)),
    ):
        drawing.add_light(pyvista.Light(position=position, light_type="camera light", color=tint, intensity=strength))
    drawing.enable_ssao(radius=0.05 * size, bias=0.002 * size, kernel_size=samples, blur=True)


def _shot(drawing: Any, background: tuple[float, float, float]) -> Image:
    """(h, w, 3) the picture, averaged from a finer one."""
    drawing.set_background(background)
    drawing.render()
    fine = drawing.screenshot(return_img=True)
    height, width = fine.shape[0] // FINER, fine.shape[1] // FINER
    blocks = fine.reshape(height, FINER, width, FINER, 3).astype(np.float64)
    return np.asarray(np.rint(blocks.mean(axis=(1, 3))), np.uint8)


def _transparent(drawing: Any) -> Image:
    """(h, w, 4) from a picture on white and one on black: where they agree, something is in front."""
    white, black = (_shot(drawing, (tone, tone, tone)).astype(np.float64) for tone in (1.0, 0.0))
    alpha = np.clip(255 - (white - black).mean(axis=2, keepdims=True), 0, 255)
    color = np.divide(255 * black, alpha, out=np.zeros_like(black), where=alpha > 0)
    return np.asarray(np.rint(np.concatenate([np.clip(color, 0, 255), alpha], axis=2)), np.uint8)


def _saved(picture: Image, path: Path) -> Path:
    from PIL import Image as Pictures

    with replacing(path) as temporary:
        Pictures.fromarray(picture).save(temporary, quality=92)
    return path


def _check(
    mesh: PolygonMesh, show: Collection[str], size: tuple[int, int], background: str, path: Path | str | None
) -> None:
    if not len(mesh.points):
        raise InvalidMesh("the mesh has no points: there is nothing to draw")
    shown = {show} if isinstance(show, str) else set(show)
    if shown - set(SHOWN):
        raise InvalidParameter(f"nothing to show is called {min(shown - set(SHOWN))!r}; there are: {', '.join(SHOWN)}")
    if background not in THEMES:
        raise InvalidParameter(f"no background is called {background!r}; there are: {', '.join(THEMES)}")
    if len(size) != 2 or not all(16 <= side <= 4096 for side in size):
        raise InvalidParameter(f"a picture is 16 to 4096 pixels wide and high; given: {size}")
    if path is not None and Path(path).suffix.lower() not in FORMATS:
        raise UnsupportedFormat(f"{path}: pictures are written as {', '.join(FORMATS)}")
    if path is not None and background == "transparent" and Path(path).suffix.lower() in {".jpg", ".jpeg"}:
        raise UnsupportedFormat(f"{path}: JPEG holds no transparency; write a .png")
