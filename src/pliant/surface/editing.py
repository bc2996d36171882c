"""What all surface deformers share: a region of interest, a handle in it, and a mesh that they need."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import (
    Binding,
    Controls,
    MeshDeformer,
    Target,
    checked_controls,
    checked_out,
    require_finite,
)
from pliant.errors import InvalidControls
from pliant.mesh import CornerValues, Points, PolygonMesh
from pliant.surface.constraints import Constraints, mesh_of, vertex_set
from pliant.surface.shading import shading_normals


@dataclass(frozen=True, eq=False)
class SurfaceDeformer(MeshDeformer):
    """A deformer that edits a mesh inside a region of interest; the rest stays, bit by bit.

    Its controls are the positions of the handle's vertices, (h, 3).

    Parameters
    ----------
    roi
        The region of interest: vertex indices, or one truth value a vertex.
    handle
        Vertices of the region, likewise: what the user moves.
    goal
        (h, 3) where the handle's vertices are, in their order; None = at rest.

    Raises
    ------
    InvalidDeformer
        Indices that are negative, or repeated.
    InvalidControls
        A goal of another shape, or not finite.
    """

    roi: ArrayLike
    handle: ArrayLike
    goal: ArrayLike | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        object.__setattr__(self, "roi", vertex_set(self.roi, "roi"))
        object.__setattr__(self, "handle", vertex_set(self.handle, "handle"))
        if self.goal is not None:
            goal = checked_controls(self.goal, self._shape).copy()
            goal.flags.writeable = False
            object.__setattr__(self, "goal", goal)

    @property
    def _shape(self) -> tuple[int, int]:
        handle = np.asarray(self.handle)
        return (int(handle.sum()) if handle.dtype == bool else len(handle)), 3

    @property
    def controls(self) -> Controls:
        """(h, 3) where the handle's vertices are.

        Raises
        ------
        InvalidControls
            They are at rest, and where that is, only a binding knows.
        """
        if self.goal is None:
            raise InvalidControls(f"this {type(self).__name__} is at rest: bind it, and ask the binding for controls")
        return np.asarray(self.goal, np.float64)

    def moved(self, controls: ArrayLike) -> Self:
        """The same edit with the handle's vertices at (h, 3)."""
        return replace(self, goal=checked_controls(controls, self._shape))

    @abstractmethod
    def bind(self, target: Target) -> SurfaceBinding:
        """Do the work that depends on region, handle and mesh only.

        Raises
        ------
        InvalidTarget
            Bare points, or a mesh without some vertex of the region.
        InvalidDeformer
            No handle, a handle outside the region, or a component that nothing ties down.
        """

    def _mesh(self, target: Target) -> PolygonMesh:
        return mesh_of(target, type(self).__name__)

    def _normals(self, mesh: PolygonMesh, points: Points) -> Points | CornerValues | None:
        return shading_normals(mesh, points)


class SurfaceBinding(Binding):
    """A surface deformer bound to a mesh.

    Parameters
    ----------
    points
        (n, 3) the mesh's points.
    constraints
        What moves.
    goal
        The deformer's own.
    """

    def __init__(self, points: Points, constraints: Constraints, goal: ArrayLike | None) -> None:
        self._points, self.constraints = points, constraints
        self._rest = points[constraints.handle]
        self._goal = self._rest if goal is None else checked_controls(goal, self._rest.shape)

    @property
    def rest(self) -> Controls:
        """(h, 3) where the handle's vertices are on the mesh."""
        return self._rest

    @property
    def controls(self) -> Controls:
        return self._goal

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        goal, result = self._checked(controls), checked_out(out, len(self._points))
        np.copyto(result, self._points)
        if not np.array_equal(goal, self._rest):
            self._edit(goal, result)
            require_finite(result, "the edit")
        return result

    @abstractmethod
    def _edit(self, goal: Controls, points: Points) -> None:
        """Overwrite the rows of ``points`` that move; they come with the mesh's positions."""


def spread_to(count: int, rows: NDArray[np.int64], values: Points) -> Points:
    """(count, 3) zero, but for some rows."""
    result = np.zeros((count, 3))
    result[rows] = values
    return result
