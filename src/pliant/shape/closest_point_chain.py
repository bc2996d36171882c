"""What a target says of a model's coefficients: a log density of closest points, and proposals towards them.

The proposal is the posterior of the model given the closest points of the present shape (Madsen et al. 2020, sec. 4).
Points slide along the target: only distances off it count, as in the density. A step goes part of the way to that
posterior and spreads as much as keeps the posterior itself unchanged (preconditioned Crank-Nicolson; Cotter et al.
2013): were the closest points to stay, each step would be accepted. Both directions of its transition density are
those of this construction, so that chains converge to the density asked for.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.shape.basis import Floats
from pliant.shape.correspondence import Target
from pliant.shape.densities import remembering
from pliant.shape.kernels import positive
from pliant.shape.linear_model import LinearModel
from pliant.shape.pose_walk import SIZE, exponential_volume, pose_matrix
from pliant.shape.procrustes import moved
from pliant.shape.sampling import NormalProposal


class ClosestPointDensity:
    """The log density of coefficients: standard normal, times normal distances of the shape from a target.

    Parameters
    ----------
    model
        The model.
    target
        A mesh of any topology, or bare points.
    noise
        The standard deviation of distances, a length.
    points
        At most so many vertices look for the target.
    pose
        ``"rigid"``: states begin with a rotation vector about the mean's centre and a shift, for
        :class:`~pliant.shape.pose_walk.PoseWalk`; rotations are as likely one as the other, and so are shifts.

    Raises
    ------
    InvalidParameter
        Noise that is not positive, or another pose.
    """

    def __init__(
        self,
        model: LinearModel,
        target: PolygonMesh,
        noise: float,
        points: int = 200,
        pose: Literal["rigid"] | None = None,
    ) -> None:
        if pose not in (None, "rigid"):
            raise InvalidParameter(f"a density has the pose 'rigid' or None, not {pose!r}")
        self._free, self._center = 0 if pose is None else SIZE, model.mean.mean(axis=0)
        self._noise = positive("the noise", noise)
        self._target = Target(target, np.pi)
        chosen = np.arange(0, len(model.mean), -(-len(model.mean) // max(1, points)))
        self._mean = model.mean[chosen]
        self._columns = np.ascontiguousarray(model.basis.rows(chosen).columns())
        self._found = remembering(self._look)

    def __call__(self, state: Floats) -> float:
        apart, _ = self._found(state)
        coefficients = state[self._free :]
        density = -0.5 * float((apart**2).sum() / self._noise**2 + coefficients @ coefficients)
        return density + float(np.log(exponential_volume(state[:3]))) if self._free else density

    def distances(self, state: Floats) -> Floats:
        """(m,) how far the points that look for the target are from it.

        Parameters
        ----------
        state
            (k,) coefficients, and the pose where it is sought too.
        """
        return np.asarray(np.linalg.norm(self._found(state)[0], axis=1))

    def proposal(self, step: float = 0.5, slide: float = 100.0) -> NormalProposal:
        """Steps from the present coefficients part of the way to the posterior of the closest points.

        Parameters
        ----------
        step
            Which part, up to 1: all the way.
        slide
            How many times farther a point may move along the target than off it.

        Raises
        ------
        InvalidParameter
            A step outside (0, 1], or a slide below one.
        """
        share = positive("the step of a proposal", step)
        if share > 1 or not slide >= 1:
            raise InvalidParameter(f"a proposal steps by 1 at most, and slides by 1 at least, not {step} and {slide}")
        spread = np.sqrt(share * (2 - share))
        across = 1 / slide

        def distribution(state: Floats) -> tuple[Floats, Floats]:
            apart, normals = self._found(state)
            if normals is None:
                rows, goal = self._columns.reshape(apart.size, -1), apart.reshape(-1)
            else:
                off = np.einsum("mi,mij->mj", normals, self._columns)
                rows = np.vstack([off, across * self._columns.reshape(apart.size, -1)])
                goal = np.concatenate([np.einsum("mi,mi->m", normals, apart), across * apart.reshape(-1)])
            rows, goal = rows / self._noise, goal / self._noise
            covariance = np.linalg.inv(np.eye(rows.shape[1]) + rows.T @ rows)
            factor = spread * np.asarray(np.linalg.cholesky((covariance + covariance.T) / 2), np.float64)
            coefficients = state[self._free :]
            mean = coefficients + share * (covariance @ (rows.T @ goal - coefficients))
            return mean, factor

        return NormalProposal(remembering(distribution), self._free)

    def _look(self, state: Floats) -> tuple[Floats, Floats | None]:
        """(m, 3) from the shape's points to the closest ones, and (m, 3) the normals there, in the model's frame."""
        points = self._mean + self._columns @ state[self._free :]
        if not self._free:
            found = self._target.correspondences(points, None)
            return found.places - points, found.normals
        matrix = pose_matrix(state, self._center)
        posed, turn = moved(matrix, points), matrix[:3, :3]
        found = self._target.correspondences(posed, None)
        return (found.places - posed) @ turn, None if found.normals is None else found.normals @ turn
