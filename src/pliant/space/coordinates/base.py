"""What all coordinates with respect to a cage have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from pliant.mesh import Points
from pliant.numerics.compute.chunks import for_chunks
from pliant.space.coordinates.surface import CageSurface, Floats

_NUMBERS = 400_000  # numbers in the rows of one piece of points: 3 MB, which stay in the cache
PIECE = 2048  # points in a piece, at most: below what is ever cut into pieces again


class Coordinates(ABC):
    """Weights of a cage's vertices, and for some kinds of its faces, at points.

    Parameters
    ----------
    surface
        The triangles on which they are computed: the cage's own, or finer ones.
    prolongation
        (p, m) how the surface's vertices follow from the cage's; None = they are the cage's.
    """

    bounded: ClassVar[bool] = False
    """Whether they exist inside the cage only; elsewhere the rows are those of the extension."""

    def __init__(self, surface: CageSurface, prolongation: csr_array | None = None) -> None:
        self.surface, self.prolongation = surface, prolongation

    @property
    def width(self) -> int:
        """How many numbers a point needs while its row is made."""
        return len(self.surface.points)

    @abstractmethod
    def rows(self, points: Floats) -> tuple[Floats, Floats | None, NDArray[np.int8]]:
        """Rows of at most 2048 points, given in the surface's unit.

        Returns
        -------
        vertices
            (k, m) weights of the cage's vertices.
        faces
            (k, t) weights of the surface's faces, in the surface's unit; None where faces have none.
        place
            (k,) 1 inside, 0 on the cage, -1 outside.
        """

    @abstractmethod
    def slopes(self, points: Floats, moves: Floats, pulls: Floats | None) -> Floats:
        """(k, 3, 3) identity + the derivative of the interpolation of (m, 3) moves and (t, 3) pulls of faces."""

    def prolonged(self, values: Points) -> Points:
        """(p, 3) values at the surface's vertices from (m, 3) at the cage's."""
        return values if self.prolongation is None else np.asarray(self.prolongation @ values)

    @property
    def piece(self) -> int:
        """How many points to take at a time."""
        return int(np.clip(_NUMBERS // self.width, 64, PIECE))

    def places(self, points: Points) -> NDArray[np.int8]:
        """(n,) for points in the cage's own unit: 1 inside, 0 on the cage, -1 outside."""
        result = np.empty(len(points), np.int8)

        def work(first: int, stop: int) -> None:
            result[first:stop] = self.rows(self.surface.scaled(points[first:stop]))[2]

        for_chunks(work, len(points), self.piece)
        return result

    def jacobian(self, points: Points, moves: Points, pulls: Floats | None) -> Floats:
        """(n, 3, 3) the derivative of the deformation at points in the cage's own unit."""
        result = np.empty((len(points), 3, 3))
        scaled = np.ascontiguousarray(moves / self.surface.scale)

        def work(first: int, stop: int) -> None:
            result[first:stop] = self.slopes(self.surface.scaled(points[first:stop]), scaled, pulls)

        for_chunks(work, len(points), self.piece)
        return result
