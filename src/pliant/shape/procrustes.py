"""Procrustes alignment: the rigid or similar map that brings points nearest to others (Kabsch 1976; Umeyama 1991)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidParameter, NotConverged
from pliant.mesh import as_points
from pliant.numerics.given import as_numbers

Floats = NDArray[np.float64]


def align(source: ArrayLike, target: ArrayLike, *, scale: bool = False, weights: ArrayLike | None = None) -> Floats:
    """(4, 4) the rotation and shift, and scale if wanted, that bring points nearest to others in correspondence.

    Parameters
    ----------
    source, target
        (m, 3) points, three or more that are not in a line.
    scale
        Whether the size may change.
    weights
        (m,) how much each pair counts; None = all alike.

    Raises
    ------
    InvalidParameter
        Different numbers of points, fewer than three, points in a line, or weights that are not positive in sum.
    """
    one, two = as_points(source), as_points(target)
    if one.shape != two.shape or len(one) < 3:
        raise InvalidParameter(f"{len(one)} points are aligned with {len(two)}: at least three pairs are needed")
    share = np.ones(len(one)) if weights is None else as_numbers("weights", weights, InvalidParameter)
    if share.shape != (len(one),) or not np.isfinite(share).all() or (share < 0).any() or not share.sum() > 0:
        raise InvalidParameter("weights must be one number a pair, none negative and not all zero")
    return _aligned(one, two, share / share.sum(), scale=scale)


def _aligned(one: Floats, two: Floats, share: Floats, *, scale: bool) -> Floats:
    center_one, center_two = share @ one, share @ two
    a, b = one - center_one, two - center_two
    u, values, vt = np.linalg.svd((share[:, None] * b).T @ a)
    if not values[1] > 1e-12 * values[0]:
        raise InvalidParameter("the points lie in a line, or at one place: no rotation follows from them")
    signs = np.array([1.0, 1.0, np.sign(np.linalg.det(u @ vt))])
    size = float((values * signs).sum() / (share @ (a**2).sum(axis=1))) if scale else 1.0
    matrix = np.eye(4)
    matrix[:3, :3] = size * (u * signs) @ vt
    matrix[:3, 3] = center_two - matrix[:3, :3] @ center_one
    return matrix


def moved(matrix: Floats, points: Floats) -> Floats:
    """(..., 3) points after a (4, 4) affine map."""
    return np.asarray(points @ matrix[:3, :3].T + matrix[:3, 3])


def generalized_procrustes(
    shapes: ArrayLike, *, scale: bool = False, tolerance: float = 1e-10, iterations: int = 100
) -> tuple[Floats, Floats]:
    """Shapes in correspondence, each aligned with the mean of all (Gower 1975).

    Parameters
    ----------
    shapes
        (s, n, 3); the first tells where the mean is put.
    scale
        Whether sizes may change; the mean keeps the size of the first.
    tolerance
        Stop when the mean moves by less, relative to its size.
    iterations
        At most so many.

    Returns
    -------
    ndarray, ndarray
        (s, n, 3) the aligned shapes, and (n, 3) their mean.

    Raises
    ------
    InvalidParameter
        Another shape of the array, or points in a line.
    NotConverged
        More iterations are needed.
    """
    stacked = as_numbers("shapes", shapes, InvalidParameter)
    if stacked.ndim != 3 or stacked.shape[2] != 3 or not len(stacked) or not np.isfinite(stacked).all():
        raise InvalidParameter(f"shapes are (s, n, 3) finite numbers, not of shape {stacked.shape}")
    mean = stacked[0]
    size = float(np.linalg.norm(mean - mean.mean(axis=0))) or 1.0
    for _ in range(iterations):
        aligned = np.stack([moved(align(each, mean, scale=scale), each) for each in stacked])
        new = moved(align(aligned.mean(axis=0), stacked[0]), aligned.mean(axis=0))
        if scale:
            middle = new.mean(axis=0)
            new = middle + (new - middle) * (size / float(np.linalg.norm(new - middle)))
        change, mean = float(np.linalg.norm(new - mean)), new
        if change < tolerance * size:
            return np.stack([moved(align(each, mean, scale=scale), each) for each in stacked]), mean
    raise NotConverged(f"the mean still moves by {change:.3g} after {iterations} rounds: allow more iterations")
