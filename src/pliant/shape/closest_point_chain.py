"""What a target says of a model's coefficients: a log density of closest points, and proposals towards them.

The proposal is the posterior of the model given the closest points of the present shape (Madsen et al. 2020, sec. 4).
Both directions of its transition density are those of this construction: chains converge to the density asked for.
"""

from __future__ import annotations

import numpy as np

from pliant.mesh import PolygonMesh
from pliant.shape.basis import Floats
from pliant.shape.correspondence import Target
from pliant.shape.kernels import positive
from pliant.shape.linear_model import LinearModel
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
    """

    def __init__(self, model: LinearModel, target: PolygonMesh, noise: float, points: int = 200) -> None:
        self._noise = positive("the noise", noise)
        self._target = Target(target, np.pi)
        chosen = np.arange(0, len(model.mean), -(-len(model.mean) // max(1, points)))
        self._mean, self._rows = model.mean[chosen], model.basis.rows(chosen)
        columns = self._rows.columns().reshape(3 * len(chosen), -1)
        self._columns = np.ascontiguousarray(columns)

    def __call__(self, coefficients: Floats) -> float:
        apart = self._goals(coefficients) - (self._columns @ coefficients).reshape(-1, 3)
        return -0.5 * float((apart**2).sum() / self._noise**2 + coefficients @ coefficients)

    def proposal(self, step: float = 0.5) -> NormalProposal:
        """Steps from the present coefficients part of the way to the posterior of the closest points.

        Parameters
        ----------
        step
            Which part; the spread is the posterior's, as much smaller.
        """
        share = positive("the step of a proposal", step)
        size = self._columns.shape[1]
        lower = np.linalg.cholesky(np.eye(size) + self._columns.T @ self._columns / self._noise**2)
        covariance = np.linalg.inv(lower @ lower.T)
        factor = np.asarray(np.linalg.cholesky((covariance + covariance.T) / 2), np.float64) * np.sqrt(share)
        gain = covariance @ self._columns.T / self._noise**2

        def distribution(state: Floats) -> tuple[Floats, Floats]:
            mean = gain @ self._goals(state).reshape(-1)
            return state + share * (mean - state), factor

        return NormalProposal(distribution)

    def _goals(self, coefficients: Floats) -> Floats:
        """(m, 3) the closest points, less the model's mean."""
        points = self._mean + (self._columns @ coefficients).reshape(-1, 3)
        return self._target.closest(points) - self._mean
