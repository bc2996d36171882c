"""A cage made smoother and tighter, as long as it encloses."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.cages.checking import check_cage
from pliant.cages.pushing import longest_sides, push_out, vertex_directions, violations
from pliant.mesh import Points, PolygonMesh

_PULL = 0.35  # of the way to the neighbours' mean
_TRIES = 6  # rounds in which vertices that went too far go back


def relaxed(cage: PolygonMesh, mesh: PolygonMesh, rounds: int, clearance: float) -> PolygonMesh:
    """Let vertices go towards their neighbours' mean, outwards where the mesh is met, and inwards where there is room.

    A round after which the cage fails its check is taken back, and the last one.

    Parameters
    ----------
    cage, mesh
        A cage that encloses the mesh.
    rounds
        How often.
    clearance
        The least step outwards; inwards, vertices go twice as far at a time.
    """
    points, triangles, best = cage.points, cage.triangles, cage.points
    for _ in range(rounds):
        means = np.zeros_like(points)
        np.add.at(means, cage.edges[:, 0], points[cage.edges[:, 1]])
        np.add.at(means, cage.edges[:, 1], points[cage.edges[:, 0]])
        means /= np.maximum(np.bincount(cage.edges.reshape(-1), minlength=len(points)), 1)[:, None]
        points, _ = push_out(points + _PULL * (means - points), triangles, mesh, clearance)
        points = _tightened(points, triangles, mesh, clearance)
        if not check_cage(cage.with_points(points), mesh).ok:
            break
        best = points
    return cage.with_points(best)


def _tightened(points: Points, triangles: NDArray[np.integer], mesh: PolygonMesh, clearance: float) -> Points:
    """Steps inwards of those vertices whose faces still enclose."""
    sizes = longest_sides(mesh)
    going = np.ones(len(points), bool)
    steps = 2 * clearance * vertex_directions(points, triangles)
    for _ in range(_TRIES):
        moved = points - np.where(going[:, None], steps, 0.0)
        wrong = violations(moved, triangles, mesh, sizes, clearance) > 0
        if not wrong.any():
            return moved
        going[triangles[wrong]] = False
    return points
