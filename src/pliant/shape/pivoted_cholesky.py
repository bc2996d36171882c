"""Pivoted Cholesky: fields from the points where most variance is missing (Harbrecht, Peters & Schneider 2012).

Pivots are taken in blocks, so that the work is in matrix products: among candidates, the worst one and others at
random, each pivot misses at least half as much as the worst.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.shape.basis import Basis, FullBasis, ScalarBasis
from pliant.shape.kernels import Floats, Kernel
from pliant.shape.low_rank import NEGLIGIBLE, LowRank, checked_rank, warn_of_little

_CANDIDATES, _BLOCK = 256, 16  # pivots are chosen among so many points, and so many at once


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
    most = checked_rank(len(residual), rank, tolerance, absolute)
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
    warn_of_little(kept, len(pivots))
    mixed = _triangular(rows[:, pivots], turn, upper=True)
    factors = rows.T @ turn
    if kernel.scalar:
        return LowRank(kernel, points[pivots], mixed, deviations, "discrete", kept), ScalarBasis(factors, deviations)
    weights = np.zeros((3 * len(pivots), len(pivots)))
    weights[3 * np.arange(len(pivots)) + pivots % 3] = mixed
    basis = FullBasis(factors.reshape(len(points), 3, -1), deviations)
    return LowRank(kernel, points[pivots // 3], weights, deviations, "discrete", kept), basis


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
