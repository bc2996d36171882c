"""Regions chosen on a picture: a rectangle or a lasso, seen through a camera."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_TALL = 512  # rows of the depth picture that tells what is in front
_SLACK = 0.01  # of the depth of the mesh: what is this little behind is in front too


def in_rectangle(
    mesh: PolygonMesh, camera: ArrayLike, low: ArrayLike, high: ArrayLike, *, visible: bool = False
) -> Integers:
    """The vertices inside a rectangle on the screen, ascending.

    Parameters
    ----------
    mesh
        The mesh.
    camera
        (4, 4) projection times view: maps homogeneous positions to clip space, where the screen is
        [-1, 1] × [-1, 1], x to the right and y upwards, and depth grows away from the viewer.
    low, high
        (2,) opposite corners, in screen coordinates.
    visible
        Whether only vertices that no face hides are taken.

    Raises
    ------
    InvalidParameter
        A camera or corners of another shape, or not finite.
    """
    (x0, y0), (x1, y1) = np.sort([_two(low), _two(high)], axis=0)
    return in_lasso(mesh, camera, [(x0, y0), (x1, y0), (x1, y1), (x0, y1)], visible=visible)


def in_lasso(mesh: PolygonMesh, camera: ArrayLike, outline: ArrayLike, *, visible: bool = False) -> Integers:
    """The vertices inside a closed outline on the screen, ascending.

    Parameters
    ----------
    outline
        (k, 2) screen coordinates, k >= 3; where it crosses itself, inside is what it winds around an odd number of
        times.
    mesh, camera, visible
        As for :func:`in_rectangle`.

    Raises
    ------
    InvalidParameter
        As for :func:`in_rectangle`.
    """
    matrix, polygon = np.asarray(camera, np.float64), np.asarray(outline, np.float64)
    if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
        raise InvalidParameter(f"a camera is a finite (4, 4) matrix; given shape: {matrix.shape}")
    if polygon.ndim != 2 or polygon.shape[1:] != (2,) or len(polygon) < 3 or not np.isfinite(polygon).all():
        raise InvalidParameter(f"an outline is (k, 2) finite screen coordinates, k >= 3; given shape: {polygon.shape}")
    clip = mesh.points @ matrix[:, :3].T + matrix[:, 3]
    front = clip[:, 3] > 1e-12 * np.abs(matrix[3]).sum()
    screen = np.zeros((len(clip), 3))
    np.divide(clip[:, :3], clip[:, 3:], out=screen, where=front[:, None])
    chosen = front & _inside(screen[:, :2], polygon)
    if visible and chosen.any():
        chosen[chosen] = _in_front(mesh, screen, front)[chosen]
    return np.flatnonzero(chosen)


def _two(corner: ArrayLike) -> Floats:
    array = np.asarray(corner, np.float64)
    if array.shape != (2,) or not np.isfinite(array).all():
        raise InvalidParameter(f"a corner is two screen coordinates; given: {corner!r}")
    return array


def _inside(points: Floats, polygon: Floats) -> NDArray[np.bool_]:
    """By counting the sides that a ray to the right crosses; the outline's own points are inside its low sides."""
    x, y = points.T
    result = np.zeros(len(points), bool)
    for (x0, y0), (x1, y1) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        if y0 != y1:
            crossed = (y0 > y) != (y1 > y)
            result ^= crossed & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    return result


def _in_front(mesh: PolygonMesh, screen: Floats, front: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which vertices a depth picture of the faces does not hide."""
    from pliant.numerics.screen_kernels import cover, hidden

    triangles = mesh.triangles[front[mesh.triangles].all(axis=1)]
    if not len(triangles):
        return front
    seen = screen[front]
    low, span = seen[:, :2].min(axis=0), np.maximum(np.ptp(seen[:, :2], axis=0), 1e-12)
    pixels = np.empty_like(screen)
    pixels[:, :2] = (screen[:, :2] - low) / span * (_TALL - 1)
    pixels[:, 2] = screen[:, 2]
    depth = np.full((_TALL, _TALL), np.inf)
    cover(pixels, triangles.astype(np.int64), depth)
    return np.asarray(front & ~hidden(pixels, depth, _SLACK * float(np.ptp(seen[:, 2]))))
