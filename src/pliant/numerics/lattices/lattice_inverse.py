"""The inverse of a tricubic lattice with its affine part, many points at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.lattices.cells import CellGrid, swept
from pliant.numerics.ragged import source

Floats = NDArray[np.float64]

_CHUNK = 4096  # points a chunk: each takes some steps


class LatticeNewton:
    """Newton's method for x' = A x + t + a tricubic sum; see :func:`pliant.numerics.maps.newton.solve`.

    Parameters
    ----------
    grid
        The cells.
    lattice
        (x, y, z, 3) control values.
    affine
        (4, 4) A and t, not singular.
    """

    def __init__(self, grid: CellGrid, lattice: Floats, affine: Floats) -> None:
        self._grid, self._lattice, self._affine = grid, lattice, np.array(affine)

    def __call__(self, images: Floats, accepted: float, iterations: int) -> tuple[Floats, Floats, Floats]:
        """(n, 3) pre-images, (n,) lengths of what is left of the residuals, (n,) det J at the pre-images."""
        from pliant.numerics.lattices.lattice_newton import invert

        grid, affine = self._grid, self._affine
        out, error, ratio = np.empty(images.shape), np.empty(len(images)), np.empty(len(images))
        back = np.linalg.inv(affine)
        begin = images if np.array_equal(back, np.eye(4)) else images @ back[:3, :3].T + back[:3, 3]
        rows, shape = swept(self._lattice)
        given, start, found = source(images.reshape(-1)), source(begin.reshape(-1)), out.reshape(-1)

        def work(first: int, stop: int) -> None:
            invert(
                given, first, stop, start, grid.frame, grid.limits, grid.keep, grid.counts, grid.stride, grid.basis,
                rows, shape, affine, accepted, iterations, found, error, ratio,
            )  # fmt: skip

        for_chunks(work, len(images), _CHUNK)
        return out, error, ratio
