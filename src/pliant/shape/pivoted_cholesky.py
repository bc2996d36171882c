"""Pivoted Cholesky: fields from the points where most variance is missing (Harbrecht, Peters & Schneider 2012).

Pivots are taken in blocks, so that the work is in matrix products: among candidates, the worst one and others at
random, each pivot misses at least half as much as the worst.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.compute.one_thread import one_blas_thread
from pliant.shape.basis import Basis, FullBasis, ScalarBasis
from pliant.shape.kernels import Floats, Kernel
from pliant.shape.low_rank import NEGLIGIBLE, LowRank, checked_rank, warn_of_little

_CANDIDATES, _BLOCK = 384, 32  # pivots are chosen among so many points, and so many at once
_LONG = 16_384  # unknowns of one product of rows
_CHUNK = 2048  # unknowns whose covariances are made, reduced and scaled while they are in cache


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
    with one_blas_thread():
        rows, pivots, kept = _pivoted(kernel, points, rank, tolerance, absolute)
        values, turn = np.linalg.eigh(_gram(rows))
        turn = turn[:, ::-1]
        mixed, factors = _triangular(rows[:, pivots], turn, upper=True), _turned(rows, turn)
    deviations = np.sqrt(np.maximum(values[::-1], NEGLIGIBLE**2 * values[-1]))
    warn_of_little(kept, len(pivots))
    if kernel.scalar:
        return LowRank(kernel, points[pivots], mixed, deviations, "discrete", kept), ScalarBasis(factors, deviations)
    weights = np.zeros((3 * len(pivots), len(pivots)))
    weights[3 * np.arange(len(pivots)) + pivots % 3] = mixed
    basis = FullBasis(factors.reshape(len(points), 3, -1), deviations)
    return LowRank(kernel, points[pivots // 3], weights, deviations, "discrete", kept), basis


def _pivoted(
    kernel: Kernel, points: Floats, rank: int | None, tolerance: float, absolute: float
) -> tuple[Floats, NDArray[np.int64], float]:
    """The rows (r, u) of the factor, their pivots (r,), and the part of the variance that they have."""
    residual = _variances(kernel, points)
    most = checked_rank(len(residual), rank, tolerance, absolute)
    total, floor = residual.sum(), max(NEGLIGIBLE * residual.max(), absolute**2)
    rows, pivots = np.empty((most, len(residual))), np.empty(0, np.int64)
    random = np.random.default_rng(0)
    while len(pivots) < most and residual.sum() > tolerance * total and residual.max() > floor:
        done = rows[: len(pivots)]
        candidates = _candidates(residual, random)
        few = done[:, candidates]
        among = _between(kernel, points, candidates) - few.T @ few
        at = _greedy(among, min(_BLOCK, most - len(pivots)), floor)
        new = candidates[at]
        fresh = rows[len(pivots) : len(pivots) + len(new)]
        _reduce(kernel, points, new, done, np.asarray(np.linalg.cholesky(among[np.ix_(at, at)])), fresh)
        held = np.einsum("rn,rn->r", fresh, fresh)
        enough = 1 + int(np.searchsorted(np.cumsum(held), residual.sum() - tolerance * total))
        fresh, new = fresh[:enough], new[:enough]
        residual = np.maximum(residual - np.einsum("rn,rn->n", fresh, fresh), 0.0)
        residual[new] = 0.0
        pivots = np.concatenate([pivots, new])
    return rows[: len(pivots)], pivots, 1 - float(residual.sum() / total)


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


def _reduce(kernel: Kernel, points: Floats, new: NDArray[np.int64], done: Floats, lower: Floats, fresh: Floats) -> None:
    """Fill in the rows (m, u) of new pivots, orthogonal to those that are done; ``lower`` is their own factor."""
    inverse = _triangular(lower, np.eye(len(lower)))
    each, own = (1 if kernel.scalar else 3), inverse @ done[:, new].T

    def work(first: int, stop: int) -> None:
        part = slice(each * first, each * stop)
        np.matmul(inverse, _columns(kernel, points[first:stop], points, new), out=fresh[:, part])
        if len(done):
            fresh[:, part] -= own @ done[:, part]

    for_chunks(work, len(points), _CHUNK)


def _gram(rows: Floats) -> Floats:
    """(r, r) the inner products of rows."""
    starts = range(0, rows.shape[1], _LONG)
    parts = np.zeros((len(starts), len(rows), len(rows)))

    def work(first: int, stop: int) -> None:
        np.matmul(rows[:, first:stop], rows[:, first:stop].T, out=parts[first // _LONG])

    for_chunks(work, rows.shape[1], _LONG)
    return np.asarray(parts.sum(axis=0))


def _turned(rows: Floats, turn: Floats) -> Floats:
    """(u, r) the columns of rows (r, u) after a rotation."""
    out = np.empty(rows.shape[::-1])

    def work(first: int, stop: int) -> None:
        np.matmul(rows[:, first:stop].T, turn, out=out[first:stop])

    for_chunks(work, len(out), _CHUNK)
    return out


def _between(kernel: Kernel, points: Floats, chosen: NDArray[np.int64]) -> Floats:
    """(m, m) covariances between unknowns: points of a scalar kernel, coordinates of points of another."""
    if kernel.scalar:
        return kernel(points[chosen], points[chosen])
    place, back = np.unique(chosen // 3, return_inverse=True)
    full = _columns(kernel, points[place], points, chosen)
    return full[:, 3 * back + chosen % 3]


def _columns(kernel: Kernel, some: Floats, points: Floats, pivots: NDArray[np.int64]) -> Floats:
    """(m, u) covariances of pivots with the unknowns of some points."""
    if kernel.scalar:
        return kernel.block(some, points[pivots]).T
    full = kernel.block(some, points[pivots // 3])
    return np.asarray(full[:, :, np.arange(len(pivots)), pivots % 3].reshape(-1, len(pivots)).T)


def _triangular(matrix: Floats, values: Floats, *, upper: bool = False) -> Floats:
    from scipy.linalg import solve_triangular

    return np.asarray(solve_triangular(matrix, values, lower=not upper, check_finite=False))
