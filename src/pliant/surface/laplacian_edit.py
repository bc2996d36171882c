"""Laplacian editing: the handle moves, and differential coordinates stay as they are as far as they can."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csc_array, csr_array, diags_array
from scipy.sparse.linalg import LinearOperator

from pliant.deformer import Controls, LinearBinding, Target, checked_controls
from pliant.errors import InvalidDeformer
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.given import as_numbers
from pliant.numerics.meshes.graphs import grown
from pliant.numerics.meshes.laplacians import WEIGHTS, laplacian, masses, normalized
from pliant.numerics.sparse.sparse_cholesky import Cholesky
from pliant.surface.constraints import Constraints, constrain
from pliant.surface.editing import SurfaceBinding, SurfaceDeformer
from pliant.surface.similarity import similarity_equations

Method = Literal["biharmonic", "naive", "similarity"]
_METHODS = ("biharmonic", "naive", "similarity")


@dataclass(frozen=True, eq=False)
class LaplacianEdit(SurfaceDeformer):
    """Keep the differential coordinates δ = L x while the handle moves (Sorkine et al. 2004).

    ``"biharmonic"`` minimises |L u|² over displacements u with the handle exactly at its goal: fast and smooth.
    ``"naive"`` is the paper's eq. 5: |L x - δ|² + Σ w² |x - c|², the handle being drawn, not held. Neither turns
    details along. ``"similarity"`` does: each vertex's δ is turned and scaled by the similarity that fits its
    neighbours best, found in the same solve (eqs. 6 to 10).

    Parameters
    ----------
    roi
        The region of interest: indices of vertices, or a mask of all. What lies outside stays, bit by bit.
    handle
        Vertices in the region that the user moves, likewise.
    goal
        (h, 3) where the handle's vertices shall be: the controls; None = where they are.
    method
        One of the three.
    weights
        Edge weights: ``"cotangent"``, ``"intrinsic"``, ``"uniform"`` or ``"mean value"`` (not for ``"biharmonic"``,
        which needs symmetric ones).
    pull
        w, how strongly the handle's vertices are drawn: one number, or (h,). Not used by ``"biharmonic"``.
    """

    method: Method = field(default="biharmonic", kw_only=True)
    weights: str = field(default="cotangent", kw_only=True)
    pull: ArrayLike = field(default=1.0, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.method not in _METHODS:
            raise InvalidDeformer(f"no method is called {self.method!r}; there are: {', '.join(_METHODS)}")
        allowed = [name for name in WEIGHTS if self.method != "biharmonic" or name != "mean value"]
        if self.weights not in allowed:
            raise InvalidDeformer(f"{self.method!r} knows no weights {self.weights!r}; it knows: {', '.join(allowed)}")
        pull = as_numbers("pull", self.pull, InvalidDeformer)
        if pull.shape not in ((), self._shape[:1]) or not (np.isfinite(pull) & (pull > 0)).all():
            raise InvalidDeformer(f"pull is a positive number, or {self._shape[0]} of them; given: {self.pull}")

    def bind(self, target: Target) -> LaplacianBinding | SimilarityBinding:
        mesh = self._mesh(target)
        weights = WEIGHTS[self.weights](mesh.points, mesh.triangles)
        graph = csr_array(weights + weights.T)
        constraints = constrain(mesh, np.asarray(self.roi), np.asarray(self.handle), graph)
        if self.method == "biharmonic":
            return self._hard(mesh, weights, constraints)
        rows = _reached(graph, constraints)
        operator = normalized(weights)[rows]
        pull = np.broadcast_to(np.asarray(self.pull, np.float64), self._shape[:1]) ** 2
        unknown = np.concatenate([constraints.free, constraints.handle])
        drawn = np.concatenate([np.zeros(len(constraints.free)), pull])
        if self.method == "naive":
            part = csr_array(operator[:, unknown])
            factor = Cholesky(csc_array(part.T @ part + diags_array(drawn)))
            coupling = csr_array((pull, (len(constraints.free) + np.arange(len(pull)), np.arange(len(pull)))),
                                 shape=(len(unknown), len(pull)))  # fmt: skip
            return LaplacianBinding(mesh.points, constraints, self.goal, factor, coupling, unknown)
        part = similarity_equations(mesh.points, operator, rows, graph, unknown)
        factor = Cholesky(csc_array(part.T @ part + diags_array(np.repeat(drawn, 3))))
        return SimilarityBinding(mesh.points, constraints, self.goal, factor, pull)

    def _hard(self, mesh: PolygonMesh, weights: csr_array, constraints: Constraints) -> LaplacianBinding:
        """|L u|² in the norm of M^-1, over the free vertices; those of the handle are given."""
        stiffness = laplacian(weights)
        scaled = csr_array(diags_array(1 / np.sqrt(masses(mesh.points, mesh.triangles))) @ stiffness)
        part, given = csr_array(scaled[:, constraints.free]), csr_array(scaled[:, constraints.handle])
        factor = Cholesky(csc_array(part.T @ part))
        return LaplacianBinding(
            mesh.points, constraints, self.goal, factor, csr_array(-(part.T @ given)), constraints.free
        )


def _reached(graph: csr_array, constraints: Constraints) -> NDArray[np.int64]:
    """The vertices whose differential coordinates an edit can change."""
    moving = np.zeros(graph.shape[0], bool)
    moving[constraints.free] = moving[constraints.handle] = True
    return np.flatnonzero(grown(graph, moving, 1))


class LaplacianBinding(SurfaceBinding, LinearBinding):
    """Laplacian editing with each coordinate alike: displacements solve A u = C (c - c_rest).

    Parameters
    ----------
    factor
        Of A, (m, m).
    coupling
        C, (m, h).
    unknown
        (m,) the vertices that are solved for.
    """

    def __init__(
        self,
        points: Points,
        constraints: Constraints,
        goal: ArrayLike | None,
        factor: Cholesky,
        coupling: csr_array,
        unknown: NDArray[np.int64],
    ) -> None:
        super().__init__(points, constraints, goal)
        self._factor, self._coupling, self._transposed = factor, coupling, csr_array(coupling.T)
        self._unknown, self._begin = unknown, points[unknown]
        self._held = len(unknown) == len(constraints.free)  # else the handle is drawn, and solved for

    def _edit(self, goal: Controls, points: Points) -> None:
        shift = self._factor.solve(np.asarray(self._coupling @ (goal - self._rest)))
        points[self._unknown] = np.add(shift, self._begin, out=shift)
        if self._held:
            points[self.constraints.handle] = goal

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        return self._spread(checked_controls(d_controls, self._rest.shape))

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        return self._gather(checked_controls(d_points, self._points.shape))

    def _spread(self, change: NDArray[np.float64]) -> Points:
        """W applied to (h, k)."""
        result = np.zeros((len(self._points), change.shape[1]))
        result[self._unknown] = self._factor.solve(np.asarray(self._coupling @ change))
        if self._held:
            result[self.constraints.handle] = change
        return result

    def _gather(self, gradient: NDArray[np.float64]) -> Controls:
        """W transposed, applied to (n, k)."""
        result = np.asarray(self._transposed @ self._factor.solve(gradient[self._unknown]))
        return result + gradient[self.constraints.handle] if self._held else result

    @property
    def weights(self) -> LinearOperator:
        """(n, h)."""
        shape = (len(self._points), len(self._rest))

        def columns(array: Any) -> NDArray[np.float64]:
            return np.asarray(array, np.float64).reshape(len(array), -1)

        return LinearOperator(
            shape,
            dtype=np.float64,
            matvec=lambda x: self._spread(columns(x))[:, 0],
            rmatvec=lambda y: self._gather(columns(y))[:, 0],
            matmat=lambda x: self._spread(columns(x)),
            rmatmat=lambda y: self._gather(columns(y)),
        )


class SimilarityBinding(SurfaceBinding):
    """Laplacian editing with local similarities: linear too, but the three coordinates are coupled.

    Parameters
    ----------
    factor
        Of the coupled system, (3 m, 3 m), free vertices before the handle's.
    pull
        (h,) squared weights.
    """

    def __init__(
        self, points: Points, constraints: Constraints, goal: ArrayLike | None, factor: Cholesky, pull: Any
    ) -> None:
        super().__init__(points, constraints, goal)
        self._factor, self._pull = factor, np.array(pull)[:, None]
        self._unknown = np.concatenate([constraints.free, constraints.handle])

    def _edit(self, goal: Controls, points: Points) -> None:
        points += self.jvp(None, goal - self._rest)

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        right = np.zeros((len(self._unknown), 3))
        right[len(self.constraints.free) :] = self._pull * checked_controls(d_controls, self._rest.shape)
        result = np.zeros_like(self._points)
        result[self._unknown] = self._factor.solve(right.reshape(-1)).reshape(-1, 3)
        return result

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        gradient = checked_controls(d_points, self._points.shape)[self._unknown]
        solved = self._factor.solve(gradient.reshape(-1)).reshape(-1, 3)
        return np.asarray(self._pull * solved[len(self.constraints.free) :])
