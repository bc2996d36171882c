"""Fitting a model to a mesh by descent: the coefficients, and the pose, of the least robust distance (L-BFGS).

The energy is sum ρ(d / noise) + |a|² / 2 with the distances d of vertices from the target; its gradient is exact, since
the closest point does not change to first order where d does. From coarse to fine: few vertices, the strongest fields
and much noise at first; each level begins where the one before ended (Lüthi et al. 2018, section 4.2).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from pliant.deformer import checked_controls
from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.numerics.one_thread import one_blas_thread
from pliant.numerics.rotations import rotations_of
from pliant.shape import robust
from pliant.shape.basis import Floats
from pliant.shape.correspondence import Target
from pliant.shape.pose_walk import SIZE, turning_rate
from pliant.shape.procrustes import moved
from pliant.shape.registration import Fit, checked_noise, checked_target

if TYPE_CHECKING:
    from pliant.shape.linear_model import LinearModel

_MOST = 4000  # vertices of the finest level; each one before has half as many


def descend(
    model: LinearModel,
    mesh: PolygonMesh,
    *,
    start: ArrayLike | None = None,
    iterations: int = 50,
    levels: int = 4,
    noise: float | None = None,
    start_noise: float | None = None,
    pose: Literal["rigid"] | None = None,
    loss: robust.Loss = "huber",
) -> Fit:
    """Fit by L-BFGS; parameters as for :meth:`pliant.ShapeModel.descend`."""
    from scipy.optimize import minimize

    last, first = checked_noise(model, noise, start_noise)
    if iterations < 1 or levels < 1 or pose not in (None, "rigid"):
        raise InvalidParameter(
            f"a descent has at least one iteration and level, and the pose 'rigid' or None, not {pose!r}"
        )
    checked_target(model, mesh, pose)
    free = 0 if pose is None else SIZE
    state = np.zeros(free + model.count)
    if start is not None:
        state[free:] = checked_controls(start, (model.count,))
    target, count, converged = Target(mesh, np.pi), 0, False
    with one_blas_thread():
        for level in range(levels):
            left = levels - 1 - level
            energy = Energy(model, target, last * (first / last) ** (left / max(1, levels - 1)), loss, pose, 2**left)
            found = minimize(energy, state, jac=True, method="L-BFGS-B", options={"maxiter": iterations})
            state, count, converged = found.x, count + int(found.nit), bool(found.success)
    matrix = energy.pose(state)
    points = moved(matrix, model.instance(state[free:]))
    some = points[:: -(-len(points) // _MOST)]
    distance = float(np.linalg.norm(target.closest(some) - some, axis=1).mean())
    return Fit(state[free:], points, matrix, distance, "converged" if converged else "stopped", count)


class Energy:
    """Robust distances of a shape from a target, and how unlikely the shape is, with the exact gradient.

    Parameters
    ----------
    model, target
        What is fitted to what.
    noise
        The standard deviation of distances, a length.
    loss
        How they count.
    pose
        ``"rigid"``: six numbers come before the coefficients, a rotation vector and a shift.
    coarseness
        One out of so many of the vertices is looked at, and counts for all; of the fields, as many stay out.
    """

    def __init__(
        self,
        model: LinearModel,
        target: Target,
        noise: float,
        loss: robust.Loss,
        pose: Literal["rigid"] | None = None,
        coarseness: int = 1,
    ) -> None:
        self._target, self._noise, self._loss, self._free = target, noise, loss, 0 if pose is None else SIZE
        chosen = np.arange(0, len(model.mean), coarseness * -(-len(model.mean) // _MOST))
        self._mean, self._rows = model.mean[chosen], model.basis.rows(chosen)
        self._center = model.mean.mean(axis=0)
        rank = max(1, model.rank // coarseness)
        self._used = np.arange(model.count) < rank * (model.count // model.rank)

    def __call__(self, state: Floats) -> tuple[float, Floats]:
        """The energy at a state, and its gradient."""
        coefficients, matrix = state[self._free :] * self._used, self.pose(state)
        posed = moved(matrix, np.asarray(self._rows.apply(coefficients, base=self._mean), np.float64))
        found = self._target.correspondences(posed, None)
        apart, good = posed - found.places, found.good
        distance = np.linalg.norm(apart, axis=1) / self._noise
        pull = (robust.weights(distance, self._loss) * good)[:, None] * apart / self._noise**2
        energy = float(robust.losses(distance, self._loss) @ good + coefficients @ coefficients / 2)
        slope = (self._rows.transpose(pull @ matrix[:3, :3]) + coefficients) * self._used
        if not self._free:
            return energy, slope
        torque = np.cross(posed - self._center - state[3:SIZE], pull).sum(axis=0)
        return energy, np.concatenate([turning_rate(state[:3]).T @ torque, pull.sum(axis=0), slope])

    def pose(self, state: Floats) -> Floats:
        """(4, 4) the motion of a state: a turn about the mean's centre, and a shift."""
        return pose_matrix(state, self._center) if self._free else np.eye(4)


def pose_matrix(state: Floats, center: Floats) -> Floats:
    """(4, 4) the turn about a centre and the shift of a state's first six numbers."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotations_of(state[None, :3])[0]
    matrix[:3, 3] = center + state[3:SIZE] - matrix[:3, :3] @ center
    return matrix
