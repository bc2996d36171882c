"""ARAP: a mesh deforms as rigidly as possible, cell by cell."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from pliant.deformer import Controls, Target
from pliant.errors import InvalidDeformer, NonFiniteResult, NotDifferentiable
from pliant.iterative import IterativeBinding, Solution
from pliant.mesh import Points
from pliant.numerics.given import as_number
from pliant.numerics.meshes.laplacians import WEIGHTS
from pliant.numerics.rigid.rotations import nearest_rotations
from pliant.surface.cells import Cells
from pliant.surface.constraints import Constraints, constrain
from pliant.surface.editing import SurfaceBinding, SurfaceDeformer

_NOTHING = 1e-20  # of the energy of the edges themselves: what rounding leaves
_KNOWN = ("cotangent", "intrinsic", "uniform")


@dataclass(frozen=True, eq=False)
class ARAP(SurfaceDeformer):
    """As-rigid-as-possible editing (Sorkine & Alexa 2007): the handle is held, the region turns with it.

    Local steps turn the cell of every vertex as its edges ask (eq. 6); global steps place the vertices as the cells
    ask (eq. 9). The energy Σ w |e' - R e|² decreases in each, also with clamped weights: raw cotangents may be
    negative, and then it has no minimum.

    Parameters
    ----------
    roi
        The region of interest: indices of vertices, or a mask of all. What lies outside stays, bit by bit.
    handle
        Vertices in the region that the user moves, likewise.
    goal
        (h, 3) where the handle's vertices shall be: the controls; None = where they are.
    weights
        Edge weights: ``"cotangent"`` (clamped), ``"intrinsic"`` (Delaunay) or ``"uniform"``.
    smoothness
        How much neighbouring cells must turn alike (Levi & Gotsman 2015, α), relative to the area of the region;
        0 = not at all, 0.02 is visible.
    tolerance
        Relative decrease of the energy in an iteration at which it has converged.
    iterations
        How many there are at most.
    """

    weights: str = field(default="cotangent", kw_only=True)
    smoothness: float = field(default=0.0, kw_only=True)
    tolerance: float = field(default=1e-3, kw_only=True)
    iterations: int = field(default=200, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.weights not in _KNOWN:
            raise InvalidDeformer(f"ARAP knows no weights {self.weights!r}; it knows: {', '.join(_KNOWN)}")
        for name, least in (("smoothness", 0.0), ("tolerance", 0.0), ("iterations", 1)):
            value = as_number(name, getattr(self, name), InvalidDeformer)
            if value < least:
                raise InvalidDeformer(f"{name} is {value}; it must be finite, and {least} or more")

    def bind(self, target: Target) -> ARAPBinding:
        mesh = self._mesh(target)
        weights = WEIGHTS[self.weights](mesh.points, mesh.triangles)
        constraints = constrain(mesh, np.asarray(self.roi), np.asarray(self.handle), weights)
        cells = Cells(mesh.points, weights, constraints.free, self._bending(mesh.points, weights, constraints))
        return ARAPBinding(mesh.points, constraints, self.goal, cells, self.tolerance, self.iterations)

    def _bending(self, points: Points, weights: csr_array, constraints: Constraints) -> float:
        """α times an area, that of the box of what moves: the energy then scales as the mesh does."""
        moving = np.concatenate([constraints.free, constraints.handle])
        return self.smoothness * float((np.ptp(points[moving], axis=0) ** 2).sum()) / 3


class ARAPBinding(SurfaceBinding, IterativeBinding):
    """ARAP bound to a mesh: factored once.

    Parameters
    ----------
    cells
        What moves.
    tolerance, iterations
        When to stop.
    """

    def __init__(
        self,
        points: Points,
        constraints: Constraints,
        goal: ArrayLike | None,
        cells: Cells,
        tolerance: float,
        iterations: int,
    ) -> None:
        super().__init__(points, constraints, goal)
        self.cells, self._tolerance, self._most = cells, tolerance, iterations

    def solve(
        self, controls: ArrayLike | None = None, start: Points | None = None, *, iterations: int | None = None
    ) -> Solution:
        goal = self._checked(controls)
        if start is None and np.array_equal(goal, self._rest):
            return Solution(self._points.copy(), "converged", np.zeros(1))
        points = self._points.copy()
        points[self.constraints.handle] = goal
        if start is None:
            rotations, energy = self._guess(points, goal)
        else:
            points[self.constraints.free] = start[self.constraints.free]
            rotations = self.cells.identities()
            energy = self.cells.turn(points, rotations)
        return self._iterate(points, rotations, energy, self._most if iterations is None else iterations)

    def _iterate(self, points: Points, rotations: NDArray[np.float64], energy: float, most: int) -> Solution:
        energies, floor = [energy], _NOTHING * self.cells.size
        while energies[-1] > floor and len(energies) <= most:
            self.cells.settle(points, rotations)
            energies.append(self.cells.turn(points, rotations))
            if not energies[-2] - energies[-1] > self._tolerance * energies[-2]:
                break
        if not np.isfinite(energies[-1]):
            raise NonFiniteResult("ARAP left the finite numbers: are the handle's positions of the mesh's own unit?")
        stopped = len(energies) > most and energies[-2] - energies[-1] > self._tolerance * energies[-2]
        return Solution(points, "stopped" if stopped else "converged", np.array(energies))

    def _guess(self, points: Points, goal: Controls) -> tuple[NDArray[np.float64], float]:
        """Where to begin: nothing turned, or all turned as the handle and the belt are; whichever has less energy."""
        told = np.concatenate([self.constraints.handle, self.constraints.belt])
        before, after = self._points[told], points[told]
        spread = (after - after.mean(axis=0)).T @ (before - before.mean(axis=0))
        best: tuple[NDArray[np.float64], float] | None = None
        begun = points.copy()
        for rotation in (np.eye(3), nearest_rotations(spread[None])[0]):
            trial = begun.copy()
            rotations = np.tile(rotation, (len(self.cells.centers), 1, 1))
            self.cells.settle(trial, rotations)
            energy = self.cells.turn(trial, rotations)
            if best is None or energy < best[1]:
                best = rotations, energy
                points[:] = trial
        assert best is not None
        return best

    def _edit(self, goal: Controls, points: Points) -> None:
        points[:] = self.solve(goal).points

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        """Not offered.

        Raises
        ------
        NotDifferentiable
            The iteration stops before the minimum.
        """
        raise NotDifferentiable("ARAP stops before its minimum: it has no exact derivative; use LaplacianEdit")

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        """Not offered, as :meth:`jvp`.

        Raises
        ------
        NotDifferentiable
            Always.
        """
        raise NotDifferentiable("ARAP stops before its minimum: it has no exact derivative; use LaplacianEdit")
