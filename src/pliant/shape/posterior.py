"""Conditioning on observations, in the space of coefficients.

With the fields Q at the observed points, residuals y and noise covariance Σ, the coefficients have the posterior
N(M⁻¹ Qᵀ Σ⁻¹ y, M⁻¹), M = I + Qᵀ Σ⁻¹ Q (Lüthi et al. 2018, eq. 25). The points themselves are never touched: it costs
as much for a million points as for a thousand.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from pliant.errors import InvalidParameter, PliantWarning
from pliant.numerics.compute.one_thread import one_blas_thread
from pliant.shape.basis import Basis
from pliant.shape.kernels import Floats

CONTRADICTION = 6.0  # observations of one place that differ by more than so many standard deviations contradict


@dataclass(frozen=True, eq=False)
class Noise:
    """Gaussian noise of observations: one standard deviation each, or a (3, 3) covariance each."""

    precision: Floats  # (m,) or (m, 3, 3) inverse covariances
    log_determinant: float  # of the covariance of all 3 m numbers

    @classmethod
    def of(cls, noise: ArrayLike, count: int) -> Noise:
        """From a standard deviation, (m,) of them, or (3, 3) or (m, 3, 3) covariance matrices.

        Raises
        ------
        InvalidParameter
            Noise that is zero or negative, a matrix that is not positive definite, or another shape.
        """
        try:
            array = np.asarray(noise, np.float64)
        except (TypeError, ValueError) as error:
            raise InvalidParameter(f"noise must be numbers, not {noise!r}") from error
        if array.shape in ((), (count,)):
            if not ((array > 0) & (array < np.inf)).all():
                raise InvalidParameter(
                    f"the noise is {float(array.min()):g}, a standard deviation: it must be above zero (for "
                    "observations that hold exactly, take a thousandth of the shape's size)"
                )
            spread: Floats = np.asarray(np.broadcast_to(array, (count,)), np.float64)
            precision: Floats = np.asarray(1 / (spread * spread), np.float64)
            return cls(precision, 6 * float(np.log(spread).sum()))
        if array.shape not in ((3, 3), (count, 3, 3)):
            raise InvalidParameter(
                f"noise has shape {array.shape}: one number, ({count},), (3, 3) or ({count}, 3, 3) is needed"
            )
        matrices = np.broadcast_to(array, (count, 3, 3))
        usable = np.isfinite(matrices).all() and np.allclose(matrices, matrices.transpose(0, 2, 1))
        if not usable or (np.linalg.eigvalsh(matrices) <= 0).any():
            raise InvalidParameter("covariance matrices of noise must be symmetric and positive definite")
        return cls(np.asarray(np.linalg.inv(matrices), np.float64), float(np.linalg.slogdet(matrices)[1].sum()))

    def covariances(self) -> Floats:
        """(m, 3, 3) of each observation."""
        if self.precision.ndim == 1:
            return np.asarray((1 / self.precision)[:, None, None] * np.eye(3))
        return np.asarray(np.linalg.inv(self.precision), np.float64)

    def joined(self, other: Noise) -> Noise:
        """That of these observations and then others."""
        one, two = self.precision, other.precision
        if one.ndim != two.ndim:
            one, two = (p[:, None, None] * np.eye(3) if p.ndim == 1 else p for p in (one, two))
        return Noise(np.concatenate([one, two]), self.log_determinant + other.log_determinant)

    def weighted(self, values: Floats) -> Floats:
        """(m, 3) the precision times (m, 3) values."""
        if self.precision.ndim == 1:
            return np.asarray(self.precision[:, None] * values)
        return np.asarray(np.einsum("mij,mj->mi", self.precision, values))


@dataclass(frozen=True, eq=False)
class Conditioned:
    """What observations make of standard normal coefficients: mean + matrix z, with z standard normal.

    ``matrix`` is (r, r) where everything is scalar, else (k, k); ``deviations`` are of the fields Q matrix, descending.
    """

    mean: Floats
    matrix: Floats
    deviations: Floats


def condition(observed: Basis, residual: Floats, noise: Noise) -> Conditioned:
    """The posterior of the coefficients.

    Parameters
    ----------
    observed
        The fields at the observed points.
    residual
        (m, 3) the observations less the mean there.
    noise
        Of the observations.
    """
    with one_blas_thread():
        mean, lower = _solved(observed, residual, noise)
        matrix = _inverse_transposed(lower)
        deviations = observed.deviations
        if len(matrix) != len(deviations):
            deviations = np.repeat(deviations, 3)
        _, spread, turn = np.linalg.svd(deviations[:, None] * matrix)
        return Conditioned(mean, np.asarray(matrix @ turn.T), spread)


def most_likely(observed: Basis, residual: Floats, noise: Noise) -> Floats:
    """(k,) the mean of the posterior alone: what is most likely."""
    with one_blas_thread():
        return _solved(observed, residual, noise)[0]


def log_likelihood(observed: Basis, residual: Floats, noise: Noise) -> float:
    """The logarithm of the density of the observations under the model: N(0, Q Qᵀ + Σ), by Woodbury's identity."""
    with one_blas_thread():
        mean, lower = _solved(observed, residual, noise)
    weighted = noise.weighted(residual)
    square = float((weighted * residual).sum() - observed.transpose(weighted) @ mean)
    times = observed.count // len(lower)
    determinant = 2 * times * float(np.log(np.diagonal(lower)).sum()) + noise.log_determinant
    return float(-0.5 * (square + determinant + residual.size * np.log(2 * np.pi)))


def along_and_across(normals: Floats, along: float, across: float) -> Floats:
    """(m, 3, 3) covariances of noise with one standard deviation along normals (m, 3), and another across them.

    A large one across lets observations slide on the surface: what closest points know is the distance only.
    """
    outer = normals[:, :, None] * normals[:, None, :]
    return np.asarray(along**2 * outer + across**2 * (np.eye(3) - outer))


def warn_of_contradictions(places: Floats, positions: Floats, noise: Noise) -> None:
    """Say which observations of one place are farther apart than their noise explains.

    Warns
    -----
    PliantWarning
        The first pair, and how many there are.
    """
    same, first = np.unique(places, axis=0, return_inverse=True)
    if len(same) == len(places):
        return
    first = first.reshape(-1)
    start = np.full(len(same), -1)
    start[first[::-1]] = np.arange(len(places))[::-1]
    other = start[first]
    apart = positions - positions[other]
    far = np.flatnonzero((apart * noise.weighted(apart)).sum(axis=1) > CONTRADICTION**2)
    if len(far):
        warnings.warn(
            f"observations {other[far[0]]} and {far[0]} are of one place, but "
            f"{np.linalg.norm(apart[far[0]]):.3g} apart, far more than their noise ({len(far)} such pairs): their mean "
            "counts; leave one out, or allow more noise",
            PliantWarning,
            stacklevel=3,
        )


def _solved(observed: Basis, residual: Floats, noise: Noise) -> tuple[Floats, Floats]:
    """(k,) the mean, and the lower triangular factor of M."""
    from scipy.linalg import cho_solve

    gram = observed.gram(noise.precision)
    right = observed.transpose(noise.weighted(residual))
    lower = np.asarray(np.linalg.cholesky(gram + np.eye(len(gram))), np.float64)
    columns = right.reshape(len(lower), -1)
    mean = np.asarray(cho_solve((lower, True), columns, check_finite=False), np.float64)
    return mean.reshape(-1), lower


def _inverse_transposed(lower: Floats) -> Floats:
    from scipy.linalg import solve_triangular

    return np.asarray(solve_triangular(lower, np.eye(len(lower)), lower=True, check_finite=False)).T
