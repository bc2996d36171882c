"""The inverse of a tricubic lattice with its affine part, many points at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.cells import CellGrid
from pliant.numerics.chunks import for_chunks

Floats = NDArray[np.float64]


class LatticeNewton:
    """Newton's method for x' = A x + t + a tricubic sum; see :func:`pliant.numerics.newton.solve`.

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
        places = np.zeros((lattice.size // 3 + 2, 4))
        places[:-2, :3] = lattice.reshape(-1, 3)
        self._grid, self._lattice, self._affine = grid, places.reshape(-1), affine

    def __call__(self, images: Floats, accepted: float, iterations: int) -> tuple[Floats, Floats, Floats]:
        """(n, 3) pre-images, (n,) lengths of what is left of the residuals, (n,) det J at the pre-images."""
        from pliant.numerics import lattice_newton

        grid, count = self._grid, len(images)
        out, error, ratio = np.empty((count, 3)), np.empty(count), np.empty(count)
        flat, target, back = np.ascontiguousarray(images).reshape(-1), out.reshape(-1), np.linalg.inv(self._affine)

        def work(start: int, stop: int) -> None:
            lattice_newton.solve(
                start, stop, flat, grid.frame, grid.limits, grid.keep, grid.counts, grid.stride, grid.basis,
                self._lattice, grid.shape, self._affine, back, accepted, iterations, target, error, ratio,
            )  # fmt: skip

        for_chunks(work, count, 4096)
        return out, error, ratio
