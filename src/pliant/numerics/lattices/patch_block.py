"""A block of tricubic hyperpatches: parameters of points, basis functions, derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.lattices.cells import BERNSTEIN, BSPLINE

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Basis = Literal["bezier", "bspline"]

CHUNK = 2048
SAMPLES = 4  # a cell and axis, when nothing is known about where points lie
SEEDS = 8
ENOUGH, ACCEPTED = 1e-14, 1e-9  # residuals, relative to the block's size: a good one, and one that is inside


@dataclass(frozen=True, eq=False)
class PatchBlock:
    """How control points make a block.

    Parameters
    ----------
    index
        (x, y, z) the control point at each place of the lattice; a control point may stand at several places, which
        are then collapsed into one.
    bases
        Along each axis ``"bezier"``, cubic patches on 3 p + 1 places, or ``"bspline"``, uniform cubic.
    wrapped
        Along which axes the last place is followed by the first: ``"bezier"`` then has 3 p places.
    """

    index: Integers
    bases: tuple[Basis, Basis, Basis]
    wrapped: tuple[bool, bool, bool]

    @cached_property
    def cells(self) -> Integers:
        """(3,) numbers of patches."""
        counts = []
        for size, basis, wrapped in zip(self.index.shape, self.bases, self.wrapped, strict=True):
            if basis == "bezier":
                counts.append(size // 3)
            else:
                counts.append(size if wrapped else size - 3)
        return np.array(counts)

    @cached_property
    def strides(self) -> Integers:
        """(3,) places from one patch to the next."""
        return np.array([3 if basis == "bezier" else 1 for basis in self.bases])

    @cached_property
    def written_out(self) -> Integers:
        """The control point of each value that the basis sums: wrapped axes with their first places repeated."""
        index = self.index
        for axis, (basis, wrapped) in enumerate(zip(self.bases, self.wrapped, strict=True)):
            if wrapped:
                places = np.arange(index.shape[axis] + (1 if basis == "bezier" else 3))
                shift = 0 if basis == "bezier" else -1  # parameter 0 is where control point 0 is felt most
                index = np.take(index, (places + shift) % index.shape[axis], axis=axis)
        return np.ascontiguousarray(index)

    def links(self) -> list[Integers]:
        """(e, 2) along each axis the pairs of neighbours, without those that are collapsed into one."""
        found = []
        for axis, wrapped in enumerate(self.wrapped):
            index = np.moveaxis(self.index, axis, 0)
            after = np.roll(index, -1, axis=0)
            last = len(index) if wrapped else len(index) - 1
            pairs = np.stack([index[:last], after[:last]], axis=-1).reshape(-1, 2)
            found.append(pairs[pairs[:, 0] != pairs[:, 1]])
        return found

    def parameters(self, controls: Floats, points: Floats, seeds: Floats | None = None) -> tuple[Floats, Integers]:
        """Parameters of points, and which of them the block contains.

        Parameters
        ----------
        controls
            (m, 3) positions.
        points
            (n, 3) positions.
        seeds
            (n, 3) parameters to begin with; None = the best of a sampled block.

        Returns
        -------
        parameters, inside
            (k, 3) and (k,): those of the points whose residual vanishes.
        """
        from pliant.numerics.lattices import hyperpatch

        values = controls[self.written_out]
        low, high = values.min(axis=(0, 1, 2)), values.max(axis=(0, 1, 2))
        size = float(np.linalg.norm(high - low))
        near = np.flatnonzero(((points >= low - ACCEPTED * size) & (points <= high + ACCEPTED * size)).all(axis=1))
        if seeds is None:
            near, tried = self._sampled_seeds(controls, points, near)
        else:
            tried = seeds[near][:, None]
        chosen = np.ascontiguousarray(points[near])
        found, residuals, counts = np.empty((len(near), 3)), np.empty(len(near)), np.empty(len(near), np.int64)

        def work(start: int, stop: int) -> None:
            hyperpatch.invert(
                chosen, start, stop, values.reshape(-1), *self._layout, np.array(self.wrapped), tried,
                ENOUGH * size, 40, found, residuals, counts,
            )  # fmt: skip

        for_chunks(work, len(near), CHUNK)
        inside = residuals <= ACCEPTED * size
        return found[inside], near[inside]

    def differentiate(self, controls: Floats, parameters: Floats) -> tuple[Floats, Floats]:
        """(n, 3) images of parameters, and (n, 3, 3) derivatives: column = parameter."""
        from pliant.numerics.lattices import hyperpatch

        values, slopes = np.empty((len(parameters), 3)), np.empty((len(parameters), 3, 3))
        flat = np.ascontiguousarray(controls[self.written_out]).reshape(-1)

        def work(start: int, stop: int) -> None:
            hyperpatch.differentiate(parameters, start, stop, flat, *self._layout, values, slopes)

        for_chunks(work, len(parameters), CHUNK)
        return values, slopes

    def basis_values(self, parameters: Floats) -> tuple[Integers, Floats]:
        """(n, 64) control points that each parameter uses, and their basis functions there."""
        from pliant.numerics.lattices import hyperpatch

        places, shares = np.empty((len(parameters), 64), np.int64), np.empty((len(parameters), 64))
        shape, cells, strides, bases = self._layout

        def work(start: int, stop: int) -> None:
            hyperpatch.spread_basis(parameters, start, stop, shape, cells, strides, bases, places, shares)

        for_chunks(work, len(parameters), CHUNK)
        return self.written_out.reshape(-1)[places], shares

    @cached_property
    def _layout(self) -> tuple[Integers, Integers, Integers, Floats]:
        matrices = np.stack([BERNSTEIN if basis == "bezier" else BSPLINE for basis in self.bases])
        return np.array(self.written_out.shape), self.cells, self.strides, matrices

    def _sampled_seeds(self, controls: Floats, points: Floats, near: Integers) -> tuple[Integers, Floats]:
        """The points that are near a sampled block, and their nearest samples' parameters."""
        from scipy.spatial import cKDTree

        steps = [(np.arange(SAMPLES * count) + 0.5) / SAMPLES for count in self.cells]  # no edge, collapsed or not
        grid = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1)
        places, _ = self.differentiate(controls, grid.reshape(-1, 3))
        lattice = places.reshape(grid.shape)
        apart = max(float(np.linalg.norm(np.diff(lattice, axis=axis), axis=-1).max()) for axis in range(3))
        distance, which = cKDTree(places).query(points[near], k=min(SEEDS, len(places)))
        kept = distance[:, 0] <= 2 * apart
        return near[kept], np.ascontiguousarray(grid.reshape(-1, 3)[which[kept]])
