"""A deformation as arrows from where points were to where they go."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidParameter
from pliant.field.grids import MOST_POINTS, checked_box, checked_spacing, tick_count
from pliant.mesh import Points
from pliant.numerics.ragged import frozen


@dataclass(frozen=True, eq=False)
class Arrows:
    """Displacements of a regular grid of points.

    Parameters
    ----------
    positions
        (n, 3) where the arrows begin.
    vectors
        (n, 3) how far the points go.
    """

    positions: Points
    vectors: Points

    def __post_init__(self) -> None:
        object.__setattr__(self, "positions", frozen(self.positions, np.float64))
        object.__setattr__(self, "vectors", frozen(self.vectors, np.float64))

    @property
    def magnitude(self) -> NDArray[np.float64]:
        """(n,) the length of each arrow."""
        return np.asarray(np.linalg.norm(self.vectors, axis=1))


def arrows(deformer: SpaceDeformer, bounds: tuple[ArrayLike, ArrayLike], spacing: float | ArrayLike) -> Arrows:
    """Displacements of a regular grid of points.

    Parameters
    ----------
    deformer
        The map.
    bounds
        Lowest and highest corner of the grid, (3,) each.
    spacing
        Largest distance of neighbouring arrows, one for all axes or one an axis, in the mesh's own unit.

    Raises
    ------
    InvalidParameter
        An empty box, a spacing that is not positive, or more than 50 million arrows.
    """
    low, high = checked_box(bounds)
    steps = checked_spacing(spacing)
    counts = [tick_count(low[i], high[i], steps[i]) for i in range(3)]
    if np.prod(counts, dtype=float) > MOST_POINTS:
        raise InvalidParameter(f"there would be {' × '.join(map(str, counts))} arrows: enlarge the spacing")
    ticks = [np.linspace(low[i], high[i], counts[i]) for i in range(3)]
    positions = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)
    return Arrows(positions, deformer(positions) - positions)
