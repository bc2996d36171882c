"""The surface at some distance around a mesh, whatever the mesh is like: open, in pieces, not manifold."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.cages.extras import import_igl, import_measure
from pliant.mesh import Points, PolygonMesh

Triangles = NDArray[np.int64]

_FINE = 0.6  # grid cells in an offset
_MOST = 3_000_000  # grid points
_AT_ONCE = 1 << 13  # of them are asked for: meanwhile libigl keeps the interpreter from all other threads


def offset_surface(mesh: PolygonMesh, offset: float) -> tuple[Points, Triangles]:
    """The boundary of what is outside, at a distance from the mesh; hollows that the outside does not reach are filled.

    Inside is where fast winding numbers exceed one half (Barill et al. 2018), which closes holes that are small for
    their rim.

    Parameters
    ----------
    mesh
        With triangles.
    offset
        The distance, in the mesh's unit.
    """
    low, high = mesh.bounds
    room = 2.5 * offset
    spacing = max(_FINE * offset, float(np.prod(high - low + 2 * room) / _MOST) ** (1 / 3))
    counts = np.ceil((high - low + 2 * room) / spacing).astype(int) + 1
    axes = [low[i] - room + spacing * np.arange(counts[i]) for i in range(3)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    values = _signed_distance(mesh, grid).reshape(counts)
    values = _filled(np.clip(values, -4 * spacing, 4 * spacing + offset), offset)
    points, triangles, _, _ = import_measure().marching_cubes(values, offset, allow_degenerate=False)
    return np.asarray(points * spacing + low - room, np.float64), _outwards(points, triangles.astype(np.int64))


def _signed_distance(mesh: PolygonMesh, grid: Points) -> NDArray[np.float64]:
    igl = import_igl()
    points, triangles = np.ascontiguousarray(mesh.points), np.ascontiguousarray(mesh.triangles, np.int64)
    distances, size = np.empty(len(grid)), max(_AT_ONCE, len(triangles))  # each slice builds its trees anew
    for start in range(0, len(grid), size):
        some = grid[start : start + size]
        square = igl.point_mesh_squared_distance(some, points, triangles)[0]
        winding = igl.fast_winding_number(points, triangles, some)
        distances[start : start + size] = np.where(np.abs(winding) > 0.5, -1.0, 1.0) * np.sqrt(square)
    return distances


def _filled(values: NDArray[np.float64], offset: float) -> NDArray[np.float64]:
    """Values beyond the offset that are not connected to the border are brought below it."""
    from scipy.ndimage import label

    labels, _ = label(values > offset)
    hollow = (labels > 0) & (labels != labels[0, 0, 0])
    return np.where(hollow, 0.0, values)


def _outwards(points: Points, triangles: Triangles) -> Triangles:
    a, b, c = (points[triangles[:, i]] for i in range(3))
    volume = np.einsum("ti,ti->", a, np.cross(b, c))
    return triangles if volume > 0 else np.ascontiguousarray(triangles[:, ::-1])
