"""Low-rank processes: a covariance kernel as a sum of few fields, u(x) = sum_j a_j ψ_j(x) with a_j ~ N(0, 1).

The fields are ψ(x) = k(x, centers) weights: known exactly everywhere, on a mesh or off it. A scalar kernel has scalar
fields, one for all three coordinates; its rank counts those.

Pivoted Cholesky takes as centres the points where most variance is missing (Harbrecht, Peters & Schneider 2012). The
Nyström method takes the eigenvectors of the covariance between sample points (Lüthi et al. 2018, section 3.2).
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter, PliantWarning
from pliant.shape.basis import Basis, FullBasis, ScalarBasis, everywhere
from pliant.shape.expansion import expansion, expansion_slopes
from pliant.shape.kernels import Floats, Kernel
from pliant.shape.matrix_kernels import DirectedKernel

Convention = Literal["discrete", "continuous"]

NEGLIGIBLE = 1e-12  # variance relative to the largest, below which a pivot is rounding
LITTLE = 0.8  # part of the variance below which a basis is said to miss much
MOST = 5_000  # fields, where only a tolerance is given

_CANDIDATES, _BLOCK = 256, 16  # pivots are chosen among so many points, and so many at once


@dataclass(frozen=True, eq=False)
class LowRank:
    """Fields ψ(x) = k(x, centers) weights.

    Parameters
    ----------
    kernel
        The kernel.
    centers
        (p, 3).
    weights
        (p, r) for a scalar kernel; (3 p, r) for a matrix-valued one.
    deviations
        (r,) the standard deviation of each field: the square root of its eigenvalue, descending.
    convention
        What the eigenvalues are of: ``"discrete"``, the covariance matrix of all points; ``"continuous"``, that matrix
        over their number, which does not grow with it. The two are not comparable.
    kept
        Part of the variance that the fields have.
    drift
        (p, 3) the mean displacement is k(x, centers) drift; None = zero.
    """

    kernel: Kernel
    centers: Floats
    weights: Floats
    deviations: Floats
    convention: Convention
    kept: float = 1.0
    drift: Floats | None = None

    def at(self, points: Floats) -> Basis:
        """The fields at (n, 3) points."""
        covariance = self.kernel(points, self.centers)
        if self.kernel.scalar:
            return ScalarBasis(covariance @ self.weights, self.deviations)
        columns = covariance.reshape(3 * len(points), 3 * len(self.centers)) @ self.weights
        return FullBasis(columns.reshape(len(points), 3, len(self.deviations)), self.deviations)

    def mean(self, points: Floats) -> Floats:
        """(n, 3) the mean displacement at (n, 3) points."""
        if self.drift is None:
            return np.zeros_like(points)
        return expansion(self.kernel, points, self.centers, self.drift)

    def slopes(self, points: Floats, coefficients: Floats) -> Floats:
        """(n, 3, 3) the derivative of the displacement that (k,) coefficients make, at (n, 3) points."""
        values = self._values(coefficients)
        return expansion_slopes(
            self.kernel, points, self.centers, values if self.drift is None else values + self.drift
        )

    def conditioned(self, matrix: Floats, coefficients: Floats, deviations: Floats) -> LowRank:
        """The fields ψ M, about the mean that (k,) coefficients of the old fields make."""
        drift = self._values(coefficients) + (0.0 if self.drift is None else self.drift)
        if len(matrix) == self.weights.shape[1]:
            return replace(self, weights=self.weights @ matrix, deviations=deviations, drift=drift)
        kernel = DirectedKernel(self.kernel, np.eye(3))  # coordinates that depend on each other
        return replace(
            self, kernel=kernel, weights=everywhere(self.weights) @ matrix, deviations=deviations, drift=drift
        )

    def _values(self, coefficients: Floats) -> Floats:
        """(p, 3) what is summed at the centres."""
        flat = coefficients.reshape(-1, 3) if self.kernel.scalar else coefficients
        return np.asarray((self.weights @ flat).reshape(-1, 3))


def pivoted_cholesky(
    kernel: Kernel, points: Floats, rank: int | None = None, tolerance: float = 0.0, absolute: float = 0.0
) -> tuple[LowRank, Basis]:
    """Fields from the points where most variance is missing, and these fields at the points.

    Parameters
    ----------
    kernel
        The kernel.
    points
        (n, 3) where the fields shall be accurate.
    rank
        The most fields; None = as many as the tolerance needs.
    tolerance
        Stop when no more than this part of the variance is missing.
    absolute
        Stop when no coordinate of a point misses more than this standard deviation, a length.

    Raises
    ------
    InvalidParameter
        A rank below one, or a tolerance outside [0, 1).

    Warns
    -----
    PliantWarning
        The rank holds little of the variance; how much is said.
    """
    residual = _variances(kernel, points)
    most = _most(len(residual), rank, tolerance, absolute)
    total, floor = residual.sum(), max(NEGLIGIBLE * residual.max(), absolute**2)
    rows, pivots = np.empty((most, len(residual))), np.empty(0, np.int64)
    random = np.random.default_rng(0)
    while len(pivots) < most and residual.sum() > tolerance * total and residual.max() > floor:
        done = rows[: len(pivots)]
        candidates = _candidates(residual, random)
        among = _covariances(kernel, points, candidates, candidates) - done[:, candidates].T @ done[:, candidates]
        new = candidates[_greedy(among, min(_BLOCK, most - len(pivots)), floor)]
        fresh = _covariances(kernel, points, new, None) - done[:, new].T @ done
        fresh = _triangular(np.asarray(np.linalg.cholesky(fresh[:, new])), fresh)
        enough = 1 + int(np.searchsorted(np.cumsum((fresh**2).sum(axis=1)), residual.sum() - tolerance * total))
        fresh, new = fresh[:enough], new[:enough]
        rows[len(pivots) : len(pivots) + len(new)] = fresh
        residual = np.maximum(residual - np.einsum("rn,rn->n", fresh, fresh), 0.0)
        residual[new] = 0.0
        pivots = np.concatenate([pivots, new])
    rows = rows[: len(pivots)]
    values, turn = np.linalg.eigh(rows @ rows.T)
    deviations = np.sqrt(np.maximum(values[::-1], NEGLIGIBLE**2 * values[-1]))
    turn = turn[:, ::-1]
    kept = 1 - float(residual.sum() / total)
    _warn_of_little(kept, len(pivots))
    mixed = _triangular(rows[:, pivots], turn, upper=True)
    factors = rows.T @ turn
    if kernel.scalar:
        return LowRank(kernel, points[pivots], mixed, deviations, "discrete", kept), ScalarBasis(factors, deviations)
    weights = np.zeros((3 * len(pivots), len(pivots)))
    weights[3 * np.arange(len(pivots)) + pivots % 3] = mixed
    basis = FullBasis(factors.reshape(len(points), 3, -1), deviations)
    return LowRank(kernel, points[pivots // 3], weights, deviations, "discrete", kept), basis


def nystrom(kernel: Kernel, samples: Floats, rank: int | None = None, tolerance: float = 0.0) -> LowRank:
    """Fields from the eigenvectors of the covariance between (m, 3) samples; parameters as for pivoted Cholesky.

    Raises
    ------
    InvalidParameter
        A rank below one, or a tolerance outside [0, 1).

    Warns
    -----
    PliantWarning
        The rank holds little of the variance; how much is said.
    """
    covariance = kernel(samples, samples)
    size = len(samples) * (1 if kernel.scalar else 3)
    values, vectors = np.linalg.eigh(covariance.reshape(size, size))
    values, vectors = values[::-1], vectors[:, ::-1]
    most = _most(size, rank, tolerance, 0.0)
    total = float(values.sum())
    enough = 1 + int(np.searchsorted(np.cumsum(values) / total, 1 - tolerance)) if tolerance else most
    take = min(most, enough, int((values > NEGLIGIBLE * values[0]).sum()))
    values, kept = values[:take], float(values[:take].sum()) / total
    _warn_of_little(kept, take)
    deviations = np.sqrt(values / len(samples))
    return LowRank(kernel, samples, vectors[:, :take] / np.sqrt(values), deviations, "continuous", kept)


def _most(size: int, rank: int | None, tolerance: float, absolute: float) -> int:
    if rank is not None and rank < 1:
        raise InvalidParameter(f"the rank is {rank}; a model needs at least one field")
    if not 0 <= tolerance < 1 or not 0 <= absolute < np.inf:
        raise InvalidParameter(f"the tolerance is {tolerance}, a part of the variance: from 0 to below 1")
    if rank is None and not tolerance and not absolute:
        raise InvalidParameter("say how many fields there shall be: rank=, or tolerance=")
    return min(size, MOST if rank is None else rank)


def _variances(kernel: Kernel, points: Floats) -> Floats:
    if not len(points):
        raise InvalidParameter("there are no points: a model needs at least one")
    diagonal = kernel.diagonal(points)
    return diagonal if kernel.scalar else np.einsum("nii->ni", diagonal).reshape(-1)


def _candidates(residual: Floats, random: np.random.Generator) -> NDArray[np.int64]:
    """The worst point, and others at random, the likelier the more they miss (Gumbel's trick)."""
    with np.errstate(divide="ignore"):
        score = np.log(residual) + random.gumbel(size=len(residual))
    count = min(_CANDIDATES, len(residual))
    score[np.argmax(residual)] = np.inf
    chosen = np.argpartition(score, len(score) - count)[len(score) - count :]
    return chosen[residual[chosen] > 0]


def _greedy(among: Floats, count: int, floor: float) -> NDArray[np.int64]:
    """Pivots of a small covariance, the largest first, while they miss at least half as much as the first."""
    residual = np.diagonal(among).copy()
    chosen: list[int] = []
    rows = np.empty((count, len(among)))
    least = max(0.5 * float(residual.max()), floor)
    while len(chosen) < count and (not chosen or residual.max() >= least):
        at = int(np.argmax(residual))
        done = rows[: len(chosen)]
        row = (among[at] - done[:, at] @ done) / np.sqrt(residual[at])
        rows[len(chosen)] = row
        residual -= row**2
        residual[at] = 0.0
        chosen.append(at)
    return np.asarray(chosen, np.int64)


def _covariances(kernel: Kernel, points: Floats, one: NDArray[np.int64], two: NDArray[np.int64] | None) -> Floats:
    """(m, n) between unknowns: points of a scalar kernel, coordinates of points of another; two = None: all."""
    if kernel.scalar:
        return kernel(points if two is None else points[two], points[one]).T
    everything = np.arange(3 * len(points)) if two is None else two
    place, back = np.unique(everything // 3, return_inverse=True)
    full = kernel(points[place], points[one // 3])
    picked = full[:, :, np.arange(len(one)), one % 3]
    return np.asarray(picked[back, everything % 3].T)


def _triangular(matrix: Floats, values: Floats, *, upper: bool = False) -> Floats:
    from scipy.linalg import solve_triangular

    return np.asarray(solve_triangular(matrix, values, lower=not upper, check_finite=False))


def _warn_of_little(kept: float, rank: int) -> None:
    if kept < LITTLE:
        warnings.warn(
            f"{rank} fields hold {100 * kept:.0f} % of the variance: the kernel varies over too short distances; use a "
            "higher rank, a larger sigma, or tolerance=",
            PliantWarning,
            stacklevel=3,
        )
