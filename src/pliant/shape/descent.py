"""Fitting a model to a mesh by descent: the coefficients, and the pose, of the least robust distance.

From coarse to fine by L-BFGS: few vertices, the strongest fields and much noise at first; each level begins where the
one before ended (Lüthi et al. 2018, section 4.2). The gradient is exact, since the closest point does not change to
first order where the distance does. Which vertices correspond is settled between descents. At last Gauss–Newton steps
tell how far the shape still has to go, in standard deviations of what the target leaves open, and go there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from pliant.deformer import checked_controls
from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.numerics.compute.one_thread import one_blas_thread
from pliant.shape import robust
from pliant.shape.basis import Floats
from pliant.shape.correspondence import Target
from pliant.shape.descent_energy import FREE, Energy
from pliant.shape.pose_walk import SIZE
from pliant.shape.procrustes import moved
from pliant.shape.registration import Fit, Pose, checked_noise, checked_target

if TYPE_CHECKING:
    from pliant.shape.linear_model import LinearModel

NEAR = 0.1  # standard deviations of what the target leaves open: from the least energy, where it has converged
_MOST = 4000  # vertices whose distance is told
_LEAST = 1e-3  # of a step: shorter ones do not descend
_ENOUGH = 1e-4  # of the descent that the slope promises


def descend(
    model: LinearModel,
    mesh: PolygonMesh,
    *,
    start: ArrayLike | None = None,
    iterations: int = 50,
    levels: int = 4,
    noise: float | None = None,
    start_noise: float | None = None,
    pose: Pose | None = None,
    loss: robust.Loss = "huber",
    angle: float = np.pi / 3,
) -> Fit:
    """Fit by descent; parameters as for :meth:`pliant.ShapeModel.descend`."""
    from scipy.optimize import minimize

    last, first = checked_noise(model, noise, start_noise)
    if iterations < 1 or levels < 1 or pose not in FREE:
        raise InvalidParameter(
            f"a descent has at least one iteration and level, and a pose 'rigid', 'similarity' or None, not {pose!r}"
        )
    checked_target(model, mesh, pose)
    state = _start(model, mesh, pose, start)
    target, count = Target(mesh, angle), 0
    with one_blas_thread():
        for level in range(levels):
            left = levels - 1 - level
            energy = Energy(model, target, last * (first / last) ** (left / max(1, levels - 1)), loss, pose, 2**left)
            energy.believe(state)
            found = minimize(energy, state, jac=True, method="L-BFGS-B", options={"maxiter": iterations})
            state, count = found.x, count + int(found.nit)
        state, steps, status = _settled(energy, state, iterations)
    matrix, free = energy.pose(state), FREE[pose]
    points = moved(matrix, model.instance(state[free:]))
    some = points[:: -(-len(points) // _MOST)]
    distance = float(np.linalg.norm(target.closest(some) - some, axis=1).mean())
    return Fit(state[free:], points, matrix, distance, status, count + steps)


def _start(model: LinearModel, mesh: PolygonMesh, pose: Pose | None, start: ArrayLike | None) -> Floats:
    """The state to begin with; a model that may be scaled begins as large as the target, and in its middle."""
    free = FREE[pose]
    state = np.zeros(free + model.count)
    if start is not None:
        state[free:] = checked_controls(start, (model.count,))
    if pose == "similarity":
        mean = model.reference.with_points(model.mean)
        state[3:SIZE] = mesh.center - mean.center
        state[SIZE] = np.log(mesh.diagonal / mean.diagonal) if mesh.diagonal and mean.diagonal else 0.0
    return state


def _settled(energy: Energy, state: Floats, most: int) -> tuple[Floats, int, Literal["converged", "stopped"]]:
    """Gauss–Newton steps, until the least energy is near by Newton's decrement (Boyd & Vandenberghe 2004, sec. 9.5)."""
    for count in range(most):
        energy.believe(state)
        value, slope = energy(state)
        step = energy.newton(state, slope)
        promised = float(slope @ step)
        if -promised < NEAR**2:
            return state, count, "converged"
        part = 1.0
        while energy(state + part * step)[0] > value + _ENOUGH * part * promised:
            part /= 2
            if part < _LEAST:
                return state, count, "stopped"
        state = state + part * step
    return state, most, "stopped"
