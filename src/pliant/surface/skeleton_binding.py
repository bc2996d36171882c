"""Skeleton edits bound to a mesh."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csc_array, csr_array, diags_array

from pliant.deformer import Controls, checked_controls
from pliant.errors import NotDifferentiable
from pliant.iterative import IterativeBinding, Solution
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.meshes.laplacians import laplacian, masses
from pliant.numerics.rigid.twists import twist_about
from pliant.numerics.sparse.sparse_cholesky import Cholesky
from pliant.surface.cells import Cells
from pliant.surface.constraints import Constraints
from pliant.surface.contour_skeletons import ContourSkeleton
from pliant.surface.editing import SurfaceBinding
from pliant.surface.skeleton_motion import SkeletonMotion

Floats = NDArray[np.float64]


class SmoothDisplacements:
    """Displacements, smoothed inside a region over a length: (M + l⁴ L M⁻¹ L) u = M u₀, given at the rim."""

    def __init__(self, mesh: PolygonMesh, weights: csr_array, free: NDArray[np.int64], length: float) -> None:
        mass, stiffness = masses(mesh.points, mesh.triangles), laplacian(weights)
        squared = csr_array(stiffness @ diags_array(1 / mass) @ stiffness)
        self._rows = csr_array((diags_array(mass) + length**4 * squared)[free])
        self._mass, self._free = mass[free, None], free
        self._factor = Cholesky(csc_array(self._rows[:, free]))

    def __call__(self, displacements: Floats) -> None:
        wanted = self._mass * displacements[self._free]
        displacements[self._free] = 0.0
        displacements[self._free] = self._factor.solve(wanted - np.asarray(self._rows @ displacements))


class SkeletonBinding(SurfaceBinding):
    """A skeleton edit bound to a mesh.

    Parameters
    ----------
    skeleton
        Of the mesh.
    motion
        How its part in the region moves.
    moving
        (m,) the vertices that the motion carries.
    smooth
        What is done to the displacements.
    """

    def __init__(
        self,
        points: Points,
        constraints: Constraints,
        goal: ArrayLike | None,
        skeleton: ContourSkeleton,
        motion: SkeletonMotion,
        moving: NDArray[np.int64],
        smooth: SmoothDisplacements | None = None,
    ) -> None:
        super().__init__(points, constraints, goal)
        self.skeleton, self._motion, self._moving, self._smooth = skeleton, motion, moving, smooth

    def _edit(self, goal: Controls, points: Points) -> None:
        points += self._displacements(self._pose(goal))

    def _pose(self, goal: Controls) -> Floats:
        """(4,) how far the handle's mean has moved, and by what angle the handle has turned about the limb."""
        shift = (goal - self._rest).mean(axis=0)
        return np.append(shift, twist_about(self._rest, goal, self._motion.twist.axis)[0])

    def _displacements(self, pose: NDArray[Any]) -> NDArray[Any]:
        """(n, 3) for a pose of the handle, real or complex."""
        result = np.zeros(self._points.shape, pose.dtype)
        positions, twisted = self._motion.moved(pose[:3], pose[3])
        result[self._moving] = positions - self._points[self._moving]
        if self._smooth is not None:
            for part in (result.real, result.imag) if np.iscomplexobj(result) else (result,):
                self._smooth(part)
        result[self._moving] += twisted  # smooth already, and smoothing would make the limb thinner
        return result

    def _derivative(self, controls: ArrayLike | None) -> Floats:
        """(4, n, 3) by the handle's pose."""
        pose, step = self._pose(self._checked(controls)), 1e-30
        return np.stack([self._displacements(pose + 1j * step * axis).imag / step for axis in np.eye(4)])

    def _twisting(self, controls: ArrayLike | None) -> Floats:
        """(h, 3) the derivative of the handle's twist by its controls."""
        return twist_about(self._rest, self._checked(controls), self._motion.twist.axis)[1]

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        moved = checked_controls(d_controls, self._rest.shape)
        pose = np.append(moved.mean(axis=0), np.sum(self._twisting(controls) * moved))
        return np.asarray(np.einsum("c,cni->ni", pose, self._derivative(controls)))

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        gradient = checked_controls(d_points, self._points.shape)
        pose = np.einsum("cni,ni->c", self._derivative(controls), gradient)
        return np.asarray(pose[:3] / len(self._rest) + pose[3] * self._twisting(controls))


class RigidSkeletonBinding(SkeletonBinding, IterativeBinding):
    """A skeleton edit whose result is the guess of as-rigid-as-possible iterations.

    Parameters
    ----------
    cells
        The free vertices' cells.
    iterations
        How many.
    """

    def __init__(
        self,
        points: Points,
        constraints: Constraints,
        goal: ArrayLike | None,
        skeleton: ContourSkeleton,
        motion: SkeletonMotion,
        moving: NDArray[np.int64],
        cells: Cells,
        iterations: int,
    ) -> None:
        super().__init__(points, constraints, goal, skeleton, motion, moving)
        self._cells, self._iterations = cells, iterations

    def solve(
        self, controls: ArrayLike | None = None, start: Points | None = None, *, iterations: int | None = None
    ) -> Solution:
        """As :meth:`deform`, with an account; the skeleton is always the guess, whatever ``start`` is."""
        pose = self._pose(self._checked(controls))
        points = self._points + self._displacements(pose)
        if not pose.any():
            return Solution(self._points.copy(), "converged", np.zeros(1))
        rotations = self._cells.identities()
        energies = [self._cells.turn(points, rotations)]
        for _ in range(self._iterations if iterations is None else iterations):
            self._cells.settle(points, rotations)
            energies.append(self._cells.turn(points, rotations))
        return Solution(points, "stopped", np.array(energies))

    def _edit(self, goal: Controls, points: Points) -> None:
        points[:] = self.solve(goal).points

    def _derivative(self, controls: ArrayLike | None) -> Floats:
        raise NotDifferentiable("finish='rigid' iterates, and has no exact derivative: use finish='smooth'")
