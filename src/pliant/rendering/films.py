"""Pictures of a mesh that moves, one after another, through one window and by one camera."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import Points, PolygonMesh
from pliant.rendering.camera import FRAMES, view_axes
from pliant.rendering.coats import coat_of_its_own
from pliant.rendering.palette import THEMES
from pliant.rendering.pictures import FINER, Image, _check, _light, _place_camera, _shot
from pliant.rendering.solids import add_bare, add_surface
from pliant.rendering.window import plotter

_SAMPLES = 24  # of the light in hollows: what moves is looked at less closely
_ENOUGH = 200_000  # points by which the camera is placed


def draw_film(
    mesh: PolygonMesh,
    frames: NDArray[np.floating],
    *,
    size: tuple[int, int] = (800, 600),
    view: str | ArrayLike = "iso",
    up: str = "z",
    background: str = "light",
    turns: float = 0.0,
    texture: Path | str | None = None,
) -> Iterator[Image]:
    """The pictures of a film.

    Parameters
    ----------
    mesh
        What moves.
    frames
        (k, n, 3) its points.
    size, view, up, texture
        As of :func:`pliant.render`.
    background
        ``"light"`` or ``"dark"``.
    turns
        How often the viewer walks around during the film.

    Yields
    ------
    ndarray
        (h, w, 3) uint8 colours.

    Raises
    ------
    InvalidMesh, InvalidParameter, MissingExtra, NoGraphics
        As :func:`pliant.render`.
    """
    _check(mesh, ("mesh",), size, background, None)
    if background == "transparent" or not np.isfinite(turns):
        raise InvalidParameter("a film has a background, light or dark, and a finite number of turns")
    axes, theme = view_axes(view, up), THEMES[background]
    seen = _around(frames, FRAMES[up][2]) if turns else _some(frames)
    coat = coat_of_its_own(mesh, texture, checkered=False)
    with plotter((FINER * size[0], FINER * size[1])) as drawing:
        _light(drawing, float(np.linalg.norm(np.ptp(seen, axis=0))) or 1.0, _SAMPLES)
        for i, points in enumerate(frames):
            moved = mesh.with_points(points)
            drawing.clear_actors()
            add_surface(drawing, moved, coat)
            add_bare(drawing, moved, None, mesh.diagonal or 1.0)
            turned = axes @ _turn(FRAMES[up][2], 2 * np.pi * turns * i / len(frames)).T
            _place_camera(drawing, seen, turned, size[0] / size[1], 0.0)
            yield _shot(drawing, theme.background)


def _some(frames: NDArray[np.floating]) -> Points:
    """Enough of all frames' points to place the camera by."""
    flat = frames.reshape(-1, 3)
    return np.asarray(flat[:: len(flat) // _ENOUGH + 1], np.float64)


def _around(frames: NDArray[np.floating], up: Points) -> Points:
    """Points that hold the shape from wherever one stands around it: rings of its radius at its heights."""
    points = _some(frames)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    offsets = points - middle
    height = offsets @ up
    radius = float(np.linalg.norm(offsets - height[:, None] * up, axis=1).max())
    first = np.cross(up, [0.0, 1.0, 0.0] if abs(up[1]) < 0.9 else [1.0, 0.0, 0.0])
    second, angle = np.cross(up, first), np.linspace(0, 2 * np.pi, 32, endpoint=False)[:, None]
    ring = radius * (np.cos(angle) * first + np.sin(angle) * second)
    return np.vstack([middle + ring + level * up for level in (height.min(), height.max())])


def _turn(up: Points, angle: float) -> NDArray[np.float64]:
    """(3, 3) the rotation about the upward axis."""
    x, y, z = up
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)
