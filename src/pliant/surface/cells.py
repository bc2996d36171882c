"""A region cut into overlapping cells, a vertex and its edges each: what as-rigid-as-possible energies sum over."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array, diags_array

from pliant.mesh import Points
from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.meshes.graphs import grown
from pliant.numerics.meshes.laplacians import row_sums
from pliant.numerics.sparse.sparse_cholesky import Cholesky

Floats = NDArray[np.float64]

_CHUNK = 4096


class Cells:
    """The cells that free vertices touch, ready for local and global steps (Sorkine & Alexa 2007).

    Parameters
    ----------
    points
        (n, 3) at rest.
    weights
        (n, n) symmetric edge weights.
    free
        (f,) the vertices that move; their cells come first.
    bending
        How much the rotations of neighbouring cells must agree, an area (Levi & Gotsman 2015).
    """

    def __init__(self, points: Points, weights: csr_array, free: NDArray[np.int64], bending: float = 0.0) -> None:
        self.free, self._bending = free, bending
        chosen = np.zeros(len(points), bool)
        chosen[free] = True
        beside = np.flatnonzero(grown(weights, chosen, 1) & ~chosen)
        self.centers = np.concatenate([free, beside])
        rows = csr_array(weights[self.centers])
        place = np.full(len(points), -1)
        place[self.centers] = np.arange(len(self.centers))
        self._starts = rows.indptr.astype(np.int64)
        self._around = rows.indices.astype(np.int64)
        self._cell_of = place[rows.indices]
        self._weights = rows.data
        owner = np.repeat(self.centers, np.diff(rows.indptr))
        edges = points[owner] - points[rows.indices]
        self._edges = edges.reshape(-1)
        self.size = float((rows.data[:, None] * edges**2).sum())
        system = diags_array(row_sums(weights)[free]) - weights[free][:, free]
        self._factor = Cholesky(csc_array(system))

    def identities(self) -> Floats:
        """(c, 3, 3)."""
        return np.tile(np.eye(3), (len(self.centers), 1, 1))

    def turn(self, points: Points, rotations: Floats) -> float:
        """The local step: the best ``rotations`` (c, 3, 3) for given points, in place; the energy that is left."""
        from pliant.numerics.rigid import rigidity

        flat, spins, parts = points.reshape(-1), rotations.reshape(-1), []

        def work(start: int, stop: int) -> None:
            energy = rigidity.turn(
                start, stop, self._starts, self._around, self._cell_of, self.centers, self._weights, self._edges,
                flat, self._bending, spins,
            )  # fmt: skip
            parts.append((start, energy))

        if self._bending > 0:
            work(0, len(self.centers))
            return float(parts[0][1] + self._bending * rigidity.bend(self._starts, self._cell_of, self._weights, spins))
        for_chunks(work, len(self.centers), _CHUNK)
        return float(sum(energy for _, energy in sorted(parts)))

    def settle(self, points: Points, rotations: Floats) -> None:
        """The global step: the best places of the free vertices for given rotations, in place."""
        from pliant.numerics.rigid import rigidity

        flat, spins, lack = points.reshape(-1), rotations.reshape(-1), np.empty((len(self.free), 3))
        target = lack.reshape(-1)

        def work(start: int, stop: int) -> None:
            rigidity.imbalance(
                start, stop, self._starts, self._around, self._cell_of, self.centers, self._weights, self._edges,
                flat, spins, target,
            )  # fmt: skip

        for_chunks(work, len(self.free), _CHUNK)
        points[self.free] += self._factor.solve(lack)
