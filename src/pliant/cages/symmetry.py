"""Symmetric cages: one half, and its mirror image."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.cages.extras import import_manifold
from pliant.errors import InvalidParameter, InvalidTarget, MissingExtra
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.ragged import Ragged

AXES = ("x", "y", "z")
_ON = 1e-9  # of the diagonal: a vertex this near to the plane is on it


def with_mirror_image(mesh: PolygonMesh, axis: str) -> PolygonMesh:
    """A mesh together with its mirror image in the middle of its box: what encloses both can be made symmetric."""
    index = checked_axis(axis)
    mirrored = mesh.points.copy()
    mirrored[:, index] = 2 * mesh.center[index] - mirrored[:, index]
    triangles = mesh.triangles
    both = np.concatenate([triangles, triangles[:, ::-1] + len(mesh.points)])
    return PolygonMesh(np.concatenate([mesh.points, mirrored]), Ragged.of(both))


def symmetrized(cage: PolygonMesh, axis: str, place: float) -> PolygonMesh:
    """The half of a cage on the upper side of a plane, and its mirror image: exactly symmetric triangles.

    Parameters
    ----------
    cage
        A valid cage.
    axis, place
        The plane's normal, and where it is.

    Raises
    ------
    InvalidTarget
        The plane misses the cage.
    MissingExtra
        manifold3d is not installed.
    """
    index = checked_axis(axis)
    library = import_manifold()
    if library is None:
        raise MissingExtra("making a cage symmetric", "cages")
    solid = library.Manifold(library.Mesh64(np.array(cage.points), np.array(cage.triangles, np.uint64)))
    half = solid.trim_by_plane(tuple(np.eye(3)[index]), place).to_mesh64()
    points, triangles = np.array(half.vert_properties)[:, :3], np.array(half.tri_verts).astype(np.int64)
    if not len(triangles):
        raise InvalidTarget(f"the plane {axis} = {place:.6g} misses the cage")
    on = np.abs(points[:, index] - place) < _ON * cage.diagonal
    points[on, index] = place
    triangles = triangles[~on[triangles].all(axis=1)]
    return _doubled(points, triangles, on, index, place)


def checked_axis(axis: str) -> int:
    """The number of an axis."""
    if axis not in AXES:
        raise InvalidParameter(f"symmetry is {axis!r}; it must be 'x', 'y' or 'z'")
    return AXES.index(axis)


def _doubled(
    points: Points, triangles: NDArray[np.int64], on: NDArray[np.bool_], index: int, place: float
) -> PolygonMesh:
    twin = np.arange(len(points))
    twin[~on] = len(points) + np.arange(np.count_nonzero(~on))
    mirrored = points[~on]
    mirrored[:, index] = 2 * place - mirrored[:, index]
    both = np.concatenate([triangles, twin[triangles[:, ::-1]]])
    every = np.concatenate([points, mirrored])
    used = np.unique(both)
    number = np.full(len(every), -1)
    number[used] = np.arange(len(used))
    return PolygonMesh(every[used], Ragged.of(number[both]))
