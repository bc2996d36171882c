"""The inverse of a map at many points, with an answer for each: which ones have a pre-image."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import SpaceDeformer
from pliant.errors import NotConverged
from pliant.mesh import Points, as_points
from pliant.numerics.ragged import frozen


@dataclass(frozen=True, eq=False)
class InverseResult:
    """Where points came from, as far as it was found.

    Parameters
    ----------
    points
        (n, 3) pre-images; where none was found, the best guess.
    converged
        (n,) where the residual is within the tolerance.
    folded
        (n,) where det J <= 0 at the pre-image: it is not the only one.
    residual
        (n,) how far the pre-images' images are from the points, in the mesh's unit.
    """

    points: Points
    converged: NDArray[np.bool_]
    folded: NDArray[np.bool_]
    residual: NDArray[np.float64]

    def __post_init__(self) -> None:
        for name, kind in (("points", np.float64), ("converged", bool), ("folded", bool), ("residual", np.float64)):
            object.__setattr__(self, name, frozen(getattr(self, name), kind))

    @property
    def failed(self) -> NDArray[np.int64]:
        """(k,) the points without a pre-image that was found."""
        return np.flatnonzero(~self.converged)


def invert(
    deformer: SpaceDeformer, points: ArrayLike, *, tolerance: float = 1e-10, iterations: int = 50
) -> InverseResult:
    """Where (n, 3) points came from; points without a pre-image are reported, and are no error.

    :meth:`SpaceDeformer.inverse` gives the same pre-images, or an error if one is missing.

    Parameters
    ----------
    deformer
        A map of R^3.
    points
        (n, 3) images.
    tolerance
        Largest residual that counts as solved, relative to the diagonal of the points.
    iterations
        Newton steps before giving up.
    """
    images = as_points(points)
    try:
        found = deformer.inverse(images, tolerance=tolerance, iterations=iterations)
    except NotConverged:
        solution = deformer._solved(images, tolerance, iterations)
        return InverseResult(solution.points, solution.converged, solution.folded, solution.residual)
    residual = np.linalg.norm(deformer(found) - images, axis=1)
    return InverseResult(found, np.ones(len(found), bool), np.zeros(len(found), bool), residual)
