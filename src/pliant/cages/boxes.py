"""The plainest cage: a box around a mesh, of quadrangles."""

from __future__ import annotations

import numpy as np

from pliant.errors import InvalidParameter, InvalidTarget
from pliant.mesh import PolygonMesh
from pliant.numerics.ragged import Ragged


def cage_from_box(mesh: PolygonMesh, cells: tuple[int, int, int] = (1, 1, 1), margin: float = 0.05) -> PolygonMesh:
    """A box of quadrangles around a mesh.

    Parameters
    ----------
    mesh
        What to enclose.
    cells
        How many quadrangles there are along each axis.
    margin
        Room on every side, in diagonals of the mesh.

    Raises
    ------
    InvalidTarget, InvalidParameter
        A mesh without points; no cells, or a margin that is not positive.
    """
    if not len(mesh.points):
        raise InvalidTarget("a mesh without points has no box")
    if len(cells) != 3 or min(cells) < 1:
        raise InvalidParameter(f"cells is {cells}; it must be three numbers, 1 or more")
    if not 0 < margin < np.inf:
        raise InvalidParameter(f"margin is {margin}; it must be positive, in diagonals")
    low, high = mesh.bounds
    room = margin * (mesh.diagonal or 1.0)
    counts = np.array(cells)
    grid = np.stack(np.meshgrid(*[np.arange(n + 1) for n in cells], indexing="ij"), axis=-1).reshape(-1, 3)
    surface = np.flatnonzero(((grid == 0) | (grid == counts)).any(axis=1))
    place = np.full(len(grid), -1)
    place[surface] = np.arange(len(surface))
    points = low - room + grid[surface] * ((high - low + 2 * room) / counts)
    faces = place[np.concatenate([_side(counts, axis, end) for axis in range(3) for end in (0, 1)])]
    return PolygonMesh(points, Ragged.of(faces))


def _side(counts: np.ndarray, axis: int, end: int) -> np.ndarray:
    """(q, 4) the quadrangles of one side, as indices into the whole grid."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    u, v = (each.reshape(-1) for each in np.meshgrid(np.arange(counts[i]), np.arange(counts[j]), indexing="ij"))
    corners = []
    for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
        index = np.zeros((len(u), 3), np.int64)
        index[:, i], index[:, j], index[:, axis] = u + du, v + dv, end * counts[axis]
        corners.append((index[:, 0] * (counts[1] + 1) + index[:, 1]) * (counts[2] + 1) + index[:, 2])
    quads = np.stack(corners, axis=1)
    return quads if end else quads[:, ::-1]
