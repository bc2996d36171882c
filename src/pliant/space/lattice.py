"""What all lattices of control points share: a linear binding, and a drag that touches only what it must."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array
from scipy.sparse.linalg import LinearOperator

from pliant.deformer import Controls, Drag, LinearBinding, checked_controls, checked_out
from pliant.errors import InvalidControls
from pliant.mesh import Points
from pliant.space.control_maps import ControlMap, Shares

Floats = NDArray[np.float64]


class SampledBasis(Protocol):
    """A tensor-product basis at the target's points: see :class:`pliant.numerics.lattices.cells.CellPoints`."""

    points: Points

    def evaluate(self, lattice: Floats, base: Floats, out: Floats) -> None: ...
    def jacobian(self, lattice: Floats, linear: Floats) -> Floats: ...
    def transpose(self, values: Floats) -> Floats: ...
    def column(self, selected: Shares) -> tuple[NDArray[np.int32], Floats]: ...
    def basis_values(self) -> tuple[NDArray[np.int64], Floats]: ...
    @property
    def outside(self) -> NDArray[Any]: ...


class LatticeBinding(LinearBinding):
    """x' = b + sum of basis functions times the displacements of the control points.

    Parameters
    ----------
    sampled
        The basis at the target's points.
    padding
        From control points to the values that the basis sums.
    rest, displacements
        (nx, ny, nz, 3) rest positions; the deformer's own displacements.
    base
        (n, 3) b, where the points are while the lattice rests.
    """

    def __init__(
        self, sampled: SampledBasis, padding: ControlMap, rest: Controls, displacements: Controls, base: Points
    ) -> None:
        self._sampled, self._padding = sampled, padding
        self._rest, self._displacements, self._base = rest, displacements, base

    @property
    def rest(self) -> Controls:
        return self._rest

    @property
    def controls(self) -> Controls:
        return self._rest + self._displacements

    @property
    def points(self) -> Points:
        return self._sampled.points

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        given = self._displacements if controls is None else checked_controls(controls, self._rest.shape) - self._rest
        target = checked_out(out, len(self.points))
        self._sampled.evaluate(self._padding.values(given), self._base, target)
        return target

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        tangent = checked_controls(d_controls, self._rest.shape)
        target = np.empty((len(self.points), 3))
        self._sampled.evaluate(self._padding.values(tangent), np.zeros_like(target), target)
        return target

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        gradient = checked_controls(d_points, self.points.shape)
        return self._padding.transpose(self._sampled.transpose(gradient))

    def drag(self, controls: ArrayLike | None = None) -> LatticeDrag:
        return LatticeDrag(self, controls)

    @property
    def weights(self) -> LinearOperator:
        """(n, m) W, for m control points in C order, each coordinate alike."""
        count, controls = len(self.points), int(np.prod(self._rest.shape[:3]))

        def forward(columns: Floats) -> Floats:
            return by_threes(lambda c: self.jvp(None, c.reshape(self._rest.shape)), columns, count)

        def backward(columns: Floats) -> Floats:
            return by_threes(lambda p: self.vjp(None, p).reshape(-1, 3), columns, controls)

        return LinearOperator((count, controls), forward, backward, forward, np.float64, backward)

    def matrix(self) -> csr_array:
        """(n, m) W as a sparse matrix: 64 numbers a point for cubic lattices, so ask for few points."""
        columns, values = self._sampled.basis_values()
        rows = np.broadcast_to(np.arange(len(columns))[:, None], columns.shape)
        sums = self._padding.matrix()
        used = values != 0
        shape = (len(self.points), sums.shape[0])
        return csr_array((values[used], (rows[used], columns[used])), shape=shape) @ sums


class LatticeDrag(Drag):
    """A drag that recomputes the points that the moved control points reach, and no others.

    The weights of a control point are kept from its first move on: while the same one is dragged, each update is
    one multiply-add a coordinate and point.
    """

    _binding: LatticeBinding

    def __init__(self, binding: LatticeBinding, controls: ArrayLike | None = None) -> None:
        super().__init__(binding, controls)
        self._grabbed: _Column | None = None

    def update(self, controls: ArrayLike, changed: Any = None) -> NDArray[np.int32]:
        binding, new = self._binding, checked_controls(controls, self._controls.shape)
        moved = np.argwhere((new != self._controls).any(axis=-1)) if changed is None else _indices(changed, new.shape)
        if not len(moved):
            return np.empty(0, np.int32)
        if len(moved) > 1:
            return self._move_several(new, moved)
        index = tuple(int(i) for i in moved[0])
        if self._grabbed is None or self._grabbed.index != index:
            self._grabbed = _Column(binding, index, self._controls[index].copy(), self._buffer)
        self._controls[index] = new[index]
        return self._grabbed.move(new[index], self._buffer)

    def _move_several(self, new: Controls, moved: NDArray[np.int64]) -> NDArray[np.int32]:
        """Add the displacement field of the difference, in the cells that it reaches."""
        from pliant.numerics.lattices.cells import CellPoints

        self._grabbed = None
        binding, sampled = self._binding, self._binding._sampled
        rows = tuple(moved.T)
        self._controls[rows] = new[rows]
        values = binding._padding.values(self._controls - binding.rest)
        if not isinstance(sampled, CellPoints):
            sampled.evaluate(values, binding._base, self._buffer)
            return np.setdiff1d(np.arange(len(self._buffer), dtype=np.int32), sampled.outside, assume_unique=True)
        chosen = np.unique(np.concatenate([sampled.cells_of(binding._padding.shares(tuple(i))) for i in moved]))
        sampled.evaluate(values, binding._base, self._buffer, chosen)
        return sampled.points_of(chosen)


class _Column:
    """One grabbed control point: whom it reaches, how much, and where they were when it was grabbed."""

    def __init__(self, binding: LatticeBinding, index: tuple[int, ...], start: Floats, buffer: Points) -> None:
        self.index, self._start = index, start
        self._points, self._weights = binding._sampled.column(binding._padding.shares(index))
        self._anchors = buffer[self._points]

    def move(self, position: Floats, buffer: Points) -> NDArray[np.int32]:
        from pliant.numerics.lattices.cells import shift_points

        shift_points(self._points, self._weights, self._anchors, position - self._start, buffer)
        return self._points


def _indices(changed: Any, shape: tuple[int, ...]) -> NDArray[np.int64]:
    """(k, 3) control indices that the caller says have changed."""
    index = np.asarray(changed, np.int64).reshape(-1, 3) if len(changed) else np.empty((0, 3), np.int64)
    if ((index < 0) | (index >= shape[:3])).any():
        raise InvalidControls(f"a changed control {index.tolist()} is not in a lattice of shape {shape[:3]}")
    return index


def by_threes(apply: Callable[[Floats], Floats], columns: Floats, rows: int) -> Floats:
    """Apply a map of (k, 3) arrays to the columns of a matrix, three at a time."""
    matrix = np.asarray(columns, np.float64).reshape(len(columns), -1)
    result = np.empty((rows, matrix.shape[1]))
    for first in range(0, matrix.shape[1], 3):
        part = matrix[:, first : first + 3]
        padded = np.zeros((len(matrix), 3))
        padded[:, : part.shape[1]] = part
        result[:, first : first + 3] = apply(padded)[:, : part.shape[1]]
    return result.reshape(rows, *np.shape(columns)[1:])
