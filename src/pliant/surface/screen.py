"""Regions chosen on a picture: a rectangle, a lasso or the stroke of a brush, seen through a camera."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import Points, PolygonMesh

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
    return SeenMesh(mesh.points, mesh.triangles, camera).inside(outline, visible=visible)


def in_brush(
    mesh: PolygonMesh, camera: ArrayLike, path: ArrayLike, radius: ArrayLike, *, visible: bool = False
) -> Integers:
    """The vertices under the stroke of a round brush on the screen, ascending.

    Parameters
    ----------
    path
        (k, 2) screen coordinates that the middle of the brush went through, k >= 1.
    radius
        (2,) half the width and half the height of the brush, in screen coordinates: they differ as those of the
        screen do.
    mesh, camera, visible
        As for :func:`in_rectangle`.

    Raises
    ------
    InvalidParameter
        As for :func:`in_rectangle`; or a radius that is not positive.
    """
    return SeenMesh(mesh.points, mesh.triangles, camera).under(path, radius, visible=visible)


class SeenMesh:
    """A mesh seen through a camera: for several strokes, what is in front is found once.

    Parameters
    ----------
    points, triangles
        (n, 3) and (t, 3).
    camera
        As for :func:`in_rectangle`.

    Raises
    ------
    InvalidParameter
        A camera of another shape, or not finite.
    """

    def __init__(self, points: Points, triangles: NDArray[np.integer], camera: ArrayLike) -> None:
        matrix = np.asarray(camera, np.float64)
        if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
            raise InvalidParameter(f"a camera is a finite (4, 4) matrix; given shape: {matrix.shape}")
        clip = points @ matrix[:, :3].T + matrix[:, 3]
        self._triangles = triangles
        self._ahead: NDArray[np.bool_] = clip[:, 3] > 1e-12 * np.abs(matrix[3]).sum()
        self._screen = np.zeros((len(clip), 3))
        np.divide(clip[:, :3], clip[:, 3:], out=self._screen, where=self._ahead[:, None])

    def inside(self, outline: ArrayLike, *, visible: bool = False) -> Integers:
        """The vertices inside a closed outline (k, 2), as :func:`in_lasso`.

        Raises
        ------
        InvalidParameter
            Fewer than three places, or numbers that are not finite.
        """
        polygon = np.asarray(outline, np.float64)
        if polygon.ndim != 2 or polygon.shape[1:] != (2,) or len(polygon) < 3 or not np.isfinite(polygon).all():
            raise InvalidParameter(
                f"an outline is (k, 2) finite screen coordinates, k >= 3; given shape: {polygon.shape}"
            )
        return self._chosen(_inside(self._screen[:, :2], polygon), visible)

    def under(self, path: ArrayLike, radius: ArrayLike, *, visible: bool = False) -> Integers:
        """The vertices under a stroke (k, 2), as :func:`in_brush`.

        Raises
        ------
        InvalidParameter
            No place, numbers that are not finite, or a radius that is not positive.
        """
        places, size = np.asarray(path, np.float64), _two(radius)
        if places.ndim != 2 or places.shape[1:] != (2,) or not len(places) or not np.isfinite(places).all():
            raise InvalidParameter(f"a path is (k, 2) finite screen coordinates, k >= 1; given shape: {places.shape}")
        if not (size > 0).all():
            raise InvalidParameter(f"a brush's radius is two positive numbers; given: {radius!r}")
        return self._chosen(_near(self._screen[:, :2] / size, places / size), visible)

    def _chosen(self, found: NDArray[np.bool_], visible: bool) -> Integers:
        found &= self._ahead
        if visible and found.any():
            found &= self._in_front
        return np.flatnonzero(found)

    @cached_property
    def _in_front(self) -> NDArray[np.bool_]:
        """Which vertices a depth picture of the faces does not hide."""
        from pliant.numerics.meshes.screen_kernels import cover, hidden

        triangles = self._triangles[self._ahead[self._triangles].all(axis=1)]
        if not len(triangles):
            return self._ahead
        seen = self._screen[self._ahead]
        low, span = seen[:, :2].min(axis=0), np.maximum(np.ptp(seen[:, :2], axis=0), 1e-12)
        pixels = np.empty_like(self._screen)
        pixels[:, :2] = (self._screen[:, :2] - low) / span * (_TALL - 1)
        pixels[:, 2] = self._screen[:, 2]
        depth = np.full((_TALL, _TALL), np.inf)
        cover(pixels, triangles.astype(np.int64), depth)
        return np.asarray(self._ahead & ~hidden(pixels, depth, _SLACK * float(np.ptp(seen[:, 2]))))


def _two(numbers: ArrayLike) -> Floats:
    array = np.asarray(numbers, np.float64)
    if array.shape != (2,) or not np.isfinite(array).all():
        raise InvalidParameter(f"a place on the screen is two coordinates; given: {numbers!r}")
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


def _near(points: Floats, path: Floats) -> NDArray[np.bool_]:
    """Which points are within a distance of 1 of a polyline."""
    result = np.zeros(len(points), bool)
    for start, end in zip(path, np.vstack([path[1:], path[-1:]]), strict=True):
        side, away = end - start, points - start
        part = np.clip(away @ side / max(float(side @ side), 1e-300), 0.0, 1.0)
        result |= ((away - part[:, None] * side) ** 2).sum(axis=1) <= 1.0
    return result
