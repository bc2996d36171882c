"""What descent minimises: robust distances of a posed shape from a target, and how unlikely the shape is.

A state is a pose, as none, six or seven numbers (a rotation vector, a shift, the logarithm of a scale), and then the
coefficients. Distances are told in standard deviations of the noise, in the model's unit of length: a shape that
shrinks does not come nearer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pliant.errors import NotConverged
from pliant.shape import robust
from pliant.shape.basis import Floats
from pliant.shape.correspondence import Integers, Target, vertex_normals
from pliant.shape.pose_walk import SIZE, pose_matrix, turning_rate
from pliant.shape.procrustes import moved
from pliant.shape.registration import Pose

if TYPE_CHECKING:
    from pliant.shape.linear_model import LinearModel

FREE = {None: 0, "rigid": SIZE, "similarity": SIZE + 1}
_MOST = 4000  # vertices of the finest level; each one before has half as many
_FLAT = 1e-6  # of the noise: nearer, the surface's own normal tells which way is off it
_RIDGE = 1e-12  # of the curvature: a pose that a round shape does not tell stays


class Energy:
    """The energy of states, with its exact gradient and its curvature.

    Parameters
    ----------
    model, target
        What is fitted to what.
    noise
        The standard deviation of distances, a length.
    loss
        How they count.
    pose
        How the model may move.
    coarseness
        One out of so many of the vertices is looked at, and counts for all; of the fields, as many stay out.
    """

    def __init__(
        self,
        model: LinearModel,
        target: Target,
        noise: float,
        loss: robust.Loss,
        pose: Pose | None = None,
        coarseness: int = 1,
    ) -> None:
        self._model, self._target, self._noise, self._loss, self._free = model, target, noise, loss, FREE[pose]
        self._chosen = np.arange(0, len(model.mean), coarseness * -(-len(model.mean) // _MOST))
        self._mean, self._rows = model.mean[self._chosen], model.basis.rows(self._chosen)
        self._center = model.mean.mean(axis=0)
        rank = max(1, model.rank // coarseness)
        self._used = np.arange(model.count) < rank * (model.count // model.rank)
        self._good = np.ones(len(self._chosen))
        self._near: Integers | None = None

    def believe(self, state: Floats) -> None:
        """Settle which vertices correspond to the target, at a state: until the next time these count, and no others.

        Raises
        ------
        NotConverged
            Fewer than three do.
        """
        posed, triangles = self.posed(state), self._model.reference.triangles
        normals = None
        if len(triangles):
            whole = moved(self.pose(state), self._model.instance(state[self._free :] * self._used))
            normals = vertex_normals(whole, triangles)[self._chosen]
        good = self._target.correspondences(posed, normals, self._near).good
        if np.count_nonzero(good) < 3:
            raise NotConverged(
                "fewer than three points of the shape correspond to the target: align it first, allow a larger angle, "
                "or turn normals that point inwards"
            )
        self._good = good.astype(np.float64)

    def __call__(self, state: Floats) -> tuple[float, Floats]:
        """The energy at a state, and its gradient."""
        coefficients, linear = state[self._free :] * self._used, self.pose(state)[:3, :3]
        posed = self.posed(state)
        apart, distance, _ = self._apart(posed, state)
        weights = robust.weights(distance, self._loss) * self._good
        pull = weights[:, None] * apart / self._unit(state) ** 2
        energy = float(robust.losses(distance, self._loss) @ self._good + coefficients @ coefficients / 2)
        slope = (self._rows.transpose(pull @ linear) + coefficients) * self._used
        if not self._free:
            return energy, slope
        arm = posed - self._center - state[3:SIZE]
        torque = np.cross(arm, pull).sum(axis=0)
        motion = [*(turning_rate(state[:3]).T @ torque), *pull.sum(axis=0)]
        if self._free > SIZE:
            motion.append(float((pull * arm).sum() - weights @ distance**2))
        return energy, np.concatenate([motion, slope])

    def newton(self, state: Floats, slope: Floats) -> Floats:
        """The step to where a surface that is flat around each closest point would have no slope (Gauss–Newton)."""
        linear, posed = self.pose(state)[:3, :3], self.posed(state)
        apart, distance, normals = self._apart(posed, state)
        weights = robust.weights(distance, self._loss) * self._good / self._unit(state) ** 2
        precision = weights[:, None, None] * self._across(apart, normals)
        known = self._rows.gram(linear.T @ precision @ linear)
        curvature = np.zeros((len(state), len(state)))
        curvature[self._free :, self._free :] = known + np.eye(len(known))
        if self._free:
            motions = self._motions(posed, state)
            pushed = np.einsum("nij,njf->nif", precision, motions)
            curvature[: self._free, : self._free] = np.einsum("nif,nig->fg", motions, pushed)
            for i in range(self._free):
                mixed = self._rows.transpose(pushed[:, :, i] @ linear)
                curvature[i, self._free :] = curvature[self._free :, i] = mixed
        curvature += _RIDGE * np.trace(curvature) * np.eye(len(state))
        return np.asarray(-np.linalg.solve(curvature, slope), np.float64)

    def posed(self, state: Floats) -> Floats:
        """(m, 3) the vertices that are looked at, in the target's space."""
        coefficients = state[self._free :] * self._used
        return moved(self.pose(state), np.asarray(self._rows.apply(coefficients, base=self._mean), np.float64))

    def pose(self, state: Floats) -> Floats:
        """(4, 4) the motion of a state: a turn about the mean's centre, a scale, and a shift."""
        if not self._free:
            return np.eye(4)
        return pose_matrix(state, self._center, np.exp(state[SIZE]) if self._free > SIZE else 1.0)

    def _unit(self, state: Floats) -> float:
        return self._noise * (float(np.exp(state[SIZE])) if self._free > SIZE else 1.0)

    def _apart(self, posed: Floats, state: Floats) -> tuple[Floats, Floats, Floats | None]:
        """(m, 3) from the closest points, (m,) how far in standard deviations, and (m, 3) the normals there."""
        found = self._target.correspondences(posed, None, self._near)
        self._near = found.triangles
        apart = posed - found.places
        return apart, np.asarray(np.linalg.norm(apart, axis=1) / self._unit(state), np.float64), found.normals

    def _across(self, apart: Floats, normals: Floats | None) -> Floats:
        """(m, 3, 3) the directions in which the distance grows: off a surface, but everywhere from a point."""
        if normals is None:
            return np.broadcast_to(np.eye(3), (len(apart), 3, 3))
        length = np.linalg.norm(apart, axis=1)[:, None]
        far = length > _FLAT * self._noise
        away = np.where(far, apart / np.where(far, length, 1.0), normals)
        return np.asarray(away[:, :, None] * away[:, None, :])

    def _motions(self, posed: Floats, state: Floats) -> Floats:
        """(m, 3, f) how vertices move with each number of the pose."""
        arm = posed - self._center - state[3:SIZE]
        axes = turning_rate(state[:3])
        turns = np.stack([np.cross(axes[:, i], arm) for i in range(3)], axis=2)
        shifts = np.broadcast_to(np.eye(3), (len(arm), 3, 3))
        parts = [turns, shifts, arm[:, :, None]] if self._free > SIZE else [turns, shifts]
        return np.concatenate(parts, axis=2)
