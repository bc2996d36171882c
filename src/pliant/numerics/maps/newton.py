"""Inverse of a map of R^3, many points at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.errors import NotConverged

Floats = NDArray[np.float64]
Map = Callable[[Floats], Floats]
Fused = Callable[[Floats, float, int], tuple[Floats, Floats, Floats]]


@dataclass(frozen=True, eq=False)
class Solution:
    """Pre-images, as far as they were found.

    Parameters
    ----------
    images
        (n, 3) what was asked for.
    points
        (n, 3) the pre-images; where none was found, the best guess.
    residual
        (n,) lengths of y - f(x).
    converged
        (n,) where the residual is accepted.
    folded
        (n,) where det J <= 0 at the pre-image: it is not the only one.
    """

    images: Floats
    points: Floats
    residual: Floats
    converged: NDArray[np.bool_]
    folded: NDArray[np.bool_]

    def required(self) -> Floats:
        """(n, 3) the pre-images, if all were found and the map folds at none.

        Raises
        ------
        NotConverged
            Names the number of points that failed and the first one.
        """
        failed = np.flatnonzero(~self.converged)
        if len(failed) or self.folded.any():
            raise NotConverged(_explain(self.images, failed, np.flatnonzero(self.folded), self.residual))
        return self.points


def invert(f: Map, jacobian: Map, images: Floats, *, tolerance: float, iterations: int) -> Floats:
    """The pre-images that :func:`solve` finds.

    Raises
    ------
    NotConverged
        Names the number of points that failed and the first one.
    """
    return solve(f, jacobian, images, tolerance=tolerance, iterations=iterations).required()


def solve(
    f: Map, jacobian: Map, images: Floats, *, tolerance: float, iterations: int, fused: Fused | None = None
) -> Solution:
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
    fused
        A kernel to try first: from images, accepted residual and iterations to pre-images, residuals' lengths and
        det J.
    """
    if not len(images):
        none = np.zeros(0, bool)
        return Solution(images, images.copy(), np.zeros(0), none, none)
    scale = float(np.linalg.norm([np.ptp(images[:, axis]) for axis in range(3)])) or 1.0
    accepted = tolerance * scale
    if fused is None:
        x, error, ratio = images.copy(), np.full(len(images), np.inf), np.ones(len(images))
    else:
        x, error, ratio = fused(images, accepted, iterations)
    for approach in (_iterate, _follow):
        failed = np.flatnonzero(~(error <= accepted))
        if len(failed):
            found = approach(f, jacobian, images[failed], accepted, iterations)
            left = np.linalg.norm(images[failed] - f(found), axis=1)
            better = ~(left >= error[failed])
            x[failed[better]], error[failed[better]] = found[better], left[better]
            ratio[failed] = np.linalg.det(jacobian(x[failed]))
    return Solution(images, x, error, error <= accepted, ratio <= 0)


def _iterate(f: Map, jacobian: Map, images: Floats, accepted: float, iterations: int) -> Floats:
    """Fixed-point iteration, then Newton's method."""
    x = images.copy()
    _iterate_fixed_point(f, images, x)
    _newton(f, jacobian, images, x, accepted, iterations)
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


def _newton(f: Map, jacobian: Map, images: Floats, x: Floats, accepted: float, iterations: int) -> None:
    """Improve ``x`` in place."""
    residual = images - f(x)
    error = np.linalg.norm(residual, axis=1)
    active = np.flatnonzero(~(error <= accepted))
    for _ in range(iterations):
        if not len(active):
            break
        before = error[active]
        _advance(f, images, x, residual, error, active, _solve(jacobian(x[active]), residual[active]))
        active = active[~(error[active] <= accepted) & (error[active] < before)]  # one that does not move is lost


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
