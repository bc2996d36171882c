"""Direct manipulation: say where points of the shape shall go, and the controls follow.

Hsu, Hughes & Kaufman, "Direct manipulation of free-form deformations" (1992): of all moves of the controls that do
it, the least one is taken, dP = W^-1 B^T (B W^-1 B^T + lambda I)^-1 dQ, with B the weights at the points.
"""

from __future__ import annotations

import warnings
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Deformer, LinearBinding
from pliant.errors import InvalidDeformer, InvalidParameter, PliantWarning
from pliant.mesh import Points, as_points

Floats = NDArray[np.float64]
Kind = TypeVar("Kind", bound=Deformer)

COARSE = 1e8  # condition number above which the constraints ask for more than the controls can tell apart


def pull(
    deformer: Kind,
    points: ArrayLike,
    targets: ArrayLike,
    pins: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    frozen: ArrayLike | None = None,
    regularization: float = 0.0,
) -> Kind:
    """A linear deformer with its controls moved, as little as possible, so that points reach their targets.

    Parameters
    ----------
    deformer
        One whose points are linear in the controls: a lattice, sites, landmarks, coefficients. What it already does
        is the start.
    points, targets
        (q, 3) points of the undeformed space, and (q, 3) where they shall be.
    pins
        (k, 3) points of the undeformed space that stay where the deformer puts them now.
    weights
        How much each control point resists, positive, one a control point or coefficient; 1 by default.
    frozen
        Control points that stay: a boolean mask shaped as the control points, or their indices, one a row.
    regularization
        lambda: above 0 targets are approached, not reached, and the controls move less.

    Returns
    -------
    Deformer
        Of the same kind, with other controls.

    Raises
    ------
    InvalidDeformer
        The deformer is not linear.
    InvalidParameter
        Constraints that contradict each other, or points that no free control reaches.

    Warns
    -----
    PliantWarning
        The controls are too coarse for the constraints: they are ill-conditioned, or missed.
    """
    held, goals = _pair(points, targets)
    fixed = as_points(pins) if pins is not None else np.empty((0, 3))
    binding = deformer.bind(np.vstack([held, fixed]))
    if not isinstance(binding, LinearBinding):
        raise InvalidDeformer(f"a {type(deformer).__name__} is not linear in its controls: it cannot be pulled")
    moves = np.vstack([goals - binding.deform()[: len(held)], np.zeros((len(fixed), 3))])
    _refuse_contradictions(binding.points, moves)
    rest = binding.rest
    by_points = rest.ndim > 1
    matrix = _rows(binding)
    shape = rest.shape[:-1] if by_points else rest.shape
    give = _give(weights, frozen, shape).reshape(-1)
    wanted = moves if by_points else moves.reshape(-1, 1)
    change = _least_move(matrix, give, wanted, regularization)
    _tell_misses(matrix @ change - wanted, wanted, regularization, len(held))
    return deformer.moved(deformer.controls + change.reshape(rest.shape))


def _pair(points: ArrayLike, targets: ArrayLike) -> tuple[Points, Points]:
    held, goals = as_points(points), as_points(targets)
    if len(held) != len(goals):
        raise InvalidParameter(f"{len(held)} points have {len(goals)} targets: each needs one")
    return held, goals


def _refuse_contradictions(points: Points, moves: Points) -> None:
    """One point cannot have two targets."""
    size = float(np.linalg.norm(np.ptp(points, axis=0))) if len(points) else 0.0
    scale = size + float(np.abs(points).max(initial=0.0)) * 1e-3 or 1.0
    keys = np.round(points / (1e-10 * scale))
    _, first, group = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    apart = np.abs(moves - moves[first[group.reshape(-1)]]).max(axis=1, initial=0.0)
    bad = np.flatnonzero(apart > 1e-8 * scale)
    if len(bad):
        one, two = int(first[group.reshape(-1)[bad[0]]]), int(bad[0])
        raise InvalidParameter(
            f"constraints {one} and {two} contradict each other: the same point {points[two].tolist()} shall go to "
            "two places; keep one of them (pins are counted after the points)"
        )


def _rows(binding: LinearBinding) -> Floats:
    """The weights at the constraints as a dense matrix, (q, m), or (3q, p) for coefficients."""
    sparse = getattr(binding, "matrix", None)
    if sparse is not None:
        return np.asarray(sparse().toarray())
    rows, columns = binding.weights.shape
    if rows <= columns:
        return np.asarray(binding.weights.rmatmat(np.eye(rows))).T
    return np.asarray(binding.weights.matmat(np.eye(columns)))


def _give(weights: ArrayLike | None, frozen: ArrayLike | None, shape: tuple[int, ...]) -> Floats:
    """W^-1: how readily each control moves; 0 where it is frozen."""
    give = np.ones(shape)
    if weights is not None:
        stiffness = np.asarray(weights, np.float64)
        if stiffness.shape != shape:
            raise InvalidParameter(f"weights have shape {stiffness.shape}; the control points have {shape}")
        if not (stiffness > 0).all() or not np.isfinite(stiffness).all():
            raise InvalidParameter("weights must be positive and finite; to hold a control point, freeze it")
        give /= stiffness
    if frozen is not None:
        chosen = np.asarray(frozen)
        if chosen.dtype == bool:
            if chosen.shape != shape:
                raise InvalidParameter(f"the frozen mask has shape {chosen.shape}; the control points have {shape}")
            give[chosen] = 0.0
        elif chosen.size:
            give[_indices(chosen, shape)] = 0.0
    return give


def _indices(chosen: NDArray[Any], shape: tuple[int, ...]) -> tuple[NDArray[np.int64], ...]:
    index = np.asarray(chosen, np.int64).reshape(-1, len(shape))
    if ((index < 0) | (index >= shape)).any():
        raise InvalidParameter(f"a frozen control {index.tolist()} is not among control points of shape {shape}")
    return tuple(index.T)


def _least_move(matrix: Floats, give: Floats, wanted: Floats, regularization: float) -> Floats:
    """(m, d) the least move of the controls, in the norm of their weights, with the least misses."""
    if not 0 <= regularization < np.inf:
        raise InvalidParameter(f"the regularization is {regularization}; it must be zero or positive")
    scaled = matrix * np.sqrt(give)
    reach = np.linalg.norm(scaled, axis=1)
    lost = np.flatnonzero((reach == 0) & (wanted != 0).any(axis=1))
    if len(lost):
        row = int(lost[0]) // (3 if wanted.shape[1] == 1 else 1)
        raise InvalidParameter(
            f"no free control reaches constraint {row} ({len(lost)} of {len(wanted)} rows): it lies outside the "
            "deformer's reach, or all controls around it are frozen"
        )
    left, values, right = np.linalg.svd(scaled, full_matrices=False)  # no normal equations: half the digits kept
    largest = float(values.max(initial=0.0))
    kept = values > 1e-12 * largest
    if kept.any() and regularization == 0 and (largest / values[kept].min()) ** 2 > COARSE:
        warnings.warn(
            f"the constraints are ill-conditioned (condition number {(largest / values[kept].min()) ** 2:.2g}): the "
            "lattice is too coarse for points this close together; use more control points, or a regularization",
            PliantWarning,
            stacklevel=3,
        )
    gain = values[kept] / (values[kept] ** 2 + regularization)
    coefficients = right[kept].T @ (gain[:, None] * (left[:, kept].T @ wanted))
    return np.asarray(np.sqrt(give)[:, None] * coefficients)


def _tell_misses(misses: Floats, wanted: Floats, regularization: float, points: int) -> None:
    """Say so where more was asked than the controls can do."""
    largest = float(np.abs(misses).max(initial=0.0))
    if regularization == 0 and largest > 1e-6 * float(np.abs(wanted).max(initial=0.0)):
        warnings.warn(
            f"the controls cannot do all that {points} points and {len(misses.reshape(-1, 3)) - points} pins ask for: "
            f"they are missed by up to {largest:.3g}; use a finer lattice, or fewer constraints",
            PliantWarning,
            stacklevel=3,
        )
