"""Inverse of a map of R^3, many points at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from pliant.errors import NotConverged

Floats = NDArray[np.float64]
Map = Callable[[Floats], Floats]


def invert(f: Map, jacobian: Map, images: Floats, *, tolerance: float, iterations: int) -> Floats:
    """Solve f(x) = y for each row of ``images``: fixed-point iteration, Newton's method, then continuation.

    Fixed-point iteration, x <- x + y - f(x), contracts wherever the displacement's derivative is below one and
    needs no Jacobian; damped Newton steps then finish quadratically. Points that Newton's method fails on are
    followed from the identity: (1 - t) x + t f(x) = y is solved for growing t, each from the last.

    Parameters
    ----------
    f, jacobian
        The map, (k, 3) to (k, 3), and its derivative, (k, 3) to (k, 3, 3).
    images
        (n, 3) points to find the pre-images of.
    tolerance
        Accepted residual, relative to the diagonal of the images' bounding box (or 1 if they are one point).
    iterations
        Largest number of Newton steps.

    Raises
    ------
    NotConverged
        Names the number of points that failed and the first one.
    """
    x = images.copy()
    if not len(x):
        return x
    scale = float(np.linalg.norm(images.max(axis=0) - images.min(axis=0))) or 1.0
    _iterate_fixed_point(f, images, x)
    failed, error = _newton(f, jacobian, images, x, tolerance * scale, iterations)
    if len(failed):
        followed = _follow(f, jacobian, images[failed], tolerance * scale, iterations)
        left = np.linalg.norm(images[failed] - f(followed), axis=1)
        better = left < error[failed]
        x[failed[better]], error[failed[better]] = followed[better], left[better]
        failed = failed[~(error[failed] <= tolerance * scale)]
    folded = _folded(jacobian, x)
    if len(failed) or len(folded):
        raise NotConverged(_explain(images, failed, folded, error))
    return x


def _iterate_fixed_point(f: Map, images: Floats, x: Floats) -> None:
    residual = images - f(x)
    for _ in range(3):
        moved = x + residual
        left = images - f(moved)
        good = np.linalg.norm(left, axis=1) < np.linalg.norm(residual, axis=1)
        x[good], residual[good] = moved[good], left[good]
        if not good.any():
            return


def _newton(
    f: Map, jacobian: Map, images: Floats, x: Floats, accepted: float, iterations: int
) -> tuple[NDArray[np.int64], Floats]:
    """Improve ``x`` in place; the rows that did not converge, and all residuals' lengths."""
    residual = images - f(x)
    error = np.linalg.norm(residual, axis=1)
    active = np.flatnonzero(~(error <= accepted))
    for _ in range(iterations):
        if not len(active):
            break
        before = error[active]
        _advance(f, images, x, residual, error, active, _solve(jacobian(x[active]), residual[active]))
        active = active[~(error[active] <= accepted) & (error[active] < before)]  # one that does not move is lost
    return np.flatnonzero(~(error <= accepted)), error


def _follow(f: Map, jacobian: Map, images: Floats, accepted: float, iterations: int) -> Floats:
    """Pre-images along the homotopy from the identity to f."""
    x = images.copy()
    for t in np.linspace(0, 1, 17)[1:]:

        def part(p: Floats, t: float = t) -> Floats:
            return (1 - t) * p + t * f(p)

        def slope(p: Floats, t: float = t) -> Floats:
            return (1 - t) * np.eye(3) + t * jacobian(p)

        _newton(part, slope, images, x, accepted, iterations)
    return x


def _advance(
    f: Map,
    images: Floats,
    x: Floats,
    residual: Floats,
    error: Floats,
    active: NDArray[np.int64],
    step: Floats,
) -> None:
    """Take the step where it lowers the residual, half of it elsewhere, and so on."""
    pending = np.arange(len(active))
    scale = 1.0
    for _ in range(12):
        at = active[pending]
        trial = x[at] + scale * step[pending]
        left = images[at] - f(trial)
        size = np.linalg.norm(left, axis=1)
        good = size < error[at]
        x[at[good]], residual[at[good]], error[at[good]] = trial[good], left[good], size[good]
        pending = pending[~good]
        if not len(pending):
            return
        scale /= 2


def _solve(jacobian: Floats, residual: Floats) -> Floats:
    """(k, 3) Newton steps by Cramer's rule; a singular Jacobian falls back to the fixed-point step."""
    a, b, c = jacobian[:, :, 0], jacobian[:, :, 1], jacobian[:, :, 2]
    bc = np.cross(b, c)
    determinant = np.einsum("ij,ij->i", a, bc)
    size = np.linalg.norm(jacobian, axis=(1, 2)) ** 3
    regular = np.abs(determinant) > 1e-14 * size
    safe = np.where(regular, determinant, 1.0)
    adjugate = np.stack([bc, np.cross(c, a), np.cross(a, b)], axis=1)
    step = np.einsum("nij,nj->ni", adjugate, residual) / safe[:, None]
    return np.where(regular[:, None], step, residual)


def _folded(jacobian: Map, x: Floats) -> NDArray[np.int64]:
    return np.flatnonzero(np.linalg.det(jacobian(x)) <= 0)


def _explain(images: Floats, active: NDArray[np.int64], folded: NDArray[np.int64], error: Floats) -> str:
    if len(active):
        at = active[0]
        return (
            f"{len(active)} of {len(images):,} points have no inverse that was found; the first is point {at} at "
            f"{images[at]}, residual {error[at]:.3g}: the deformation folds there, or the point is outside its image"
        )
    at = folded[0]
    return (
        f"the deformation folds (det J <= 0) at the pre-images of {len(folded)} of {len(images):,} points, the first "
        f"is point {at} at {images[at]}: it has no unique inverse there"
    )
