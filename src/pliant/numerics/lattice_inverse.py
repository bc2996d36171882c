"""The inverse of a tricubic lattice with its affine part, many points at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.cells import CellGrid
from pliant.numerics.chunks import for_chunks
from pliant.numerics.ragged import source

Floats = NDArray[np.float64]

_CHUNK = 8192  # points solved together: what a chunk needs stays in the second-level cache


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
        self._grid, self._lattice, self._affine = grid, np.ascontiguousarray(lattice).reshape(-1), affine

    def __call__(self, images: Floats, accepted: float, iterations: int) -> tuple[Floats, Floats, Floats]:
        """(n, 3) pre-images, (n,) lengths of what is left of the residuals, (n,) det J at the pre-images."""
        from pliant.numerics import lattice_newton

        count = len(images)
        out, error, ratio = np.empty((count, 3)), np.empty(count), np.empty(count)

        def work(start: int, stop: int) -> None:
            part = slice(start, stop)
            state = self._solved(images[part], accepted, iterations)
            out[part] = state[:, lattice_newton.BEST : lattice_newton.STEP]
            error[part], ratio[part] = state[:, lattice_newton.LEAST], state[:, lattice_newton.RATIO]

        for_chunks(work, count, max(_CHUNK, 4 * int(self._grid.counts.prod())))
        return out, error, ratio

    def _solved(self, images: Floats, accepted: float, iterations: int) -> Floats:
        """(n, 12) what is known of a chunk in the end: sort, step, and again with those points that are not solved."""
        from pliant.numerics import lattice_newton, tricubic

        grid, left, back = self._grid, len(images), np.linalg.inv(self._affine)
        active, order = (np.arange(left, dtype=np.int32) for _ in range(2))
        local, starts = np.zeros(3 * (left + 8)), np.empty(int(grid.counts.prod()) + 2, np.int64)
        state = np.zeros((left, lattice_newton.RECORD))
        state[:, :3], state[:, lattice_newton.LEAST] = images, np.inf
        trial = images.copy() if np.array_equal(back, np.eye(4)) else images @ back[:3, :3].T + back[:3, 3]
        trial, records = trial.reshape(-1), state.reshape(-1)
        for _ in range(iterations + 1):
            tricubic.locate(
                source(trial), 0, left, grid.frame, grid.limits, grid.keep, grid.counts, order, local, starts
            )
            left = lattice_newton.advance(
                starts, order, local, grid.frame, grid.counts, grid.stride, grid.basis, self._lattice, grid.shape,
                self._affine, accepted, active, trial, records,
            )  # fmt: skip
            if not left:
                break
        return state
