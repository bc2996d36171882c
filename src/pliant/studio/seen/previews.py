"""Small shapes for small pictures: templates are shown on the scene's own mesh, with fewer vertices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points, PolygonMesh
from pliant.numerics.ragged import Ragged
from pliant.scene.recipe import Recipe
from pliant.shape.decimation import decimated
from pliant.studio.seen.drawn import DrawnMesh

MOST_VERTICES = 1100
MOMENTS = 20  # of a motion


@dataclass(frozen=True, eq=False)
class Small:
    """A mesh of few vertices.

    Parameters
    ----------
    mesh
        The mesh.
    kept
        (m,) which vertices of the large one it has.
    """

    mesh: PolygonMesh
    kept: NDArray[np.int64]

    @classmethod
    def of(cls, mesh: PolygonMesh) -> Small:
        """The vertices that are farthest from one another, and triangles between them."""
        if len(mesh.points) <= MOST_VERTICES or not len(mesh.triangles):
            return cls(PolygonMesh(mesh.points, Ragged.of(mesh.triangles)), np.arange(len(mesh.points)))
        return cls(*decimated(mesh, MOST_VERTICES))

    def at(self, points: Points) -> PolygonMesh:
        """It, where the large mesh's points are elsewhere."""
        return self.mesh.with_points(points[self.kept])


@dataclass(frozen=True, eq=False)
class Preview:
    """A template on a small mesh.

    Parameters
    ----------
    points
        (k, m, 3) moments; of one that does not move, before and after.
    normals
        (k, m, 3).
    period
        Seconds from the first moment to where it begins anew.
    """

    points: NDArray[np.float32]
    normals: NDArray[np.int8]
    period: float


def preview(recipe: Recipe, mesh: PolygonMesh, intensity: float, up: str) -> Preview:
    """A template's moments on a small mesh.

    Raises
    ------
    InvalidParameter
        The template does not fit the mesh.
    """
    if recipe.moves:
        clip = recipe.clip(mesh, intensity=intensity, up=up)
        period = clip.period
        frames = [clip.sample(time).points for time in np.arange(MOMENTS) * period / MOMENTS]
    else:
        after = recipe.stack(mesh, intensity=intensity, up=up)(mesh).points
        period = 2.0
        ways = (1 - np.cos(2 * np.pi * np.arange(MOMENTS) / MOMENTS)) / 2
        frames = [mesh.points + way * (after - mesh.points) for way in ways]
    drawn = DrawnMesh(mesh)
    normals = [drawn.normals(points) for points in frames]
    return Preview(np.array(frames, np.float32), np.array(normals, np.int8), period)
