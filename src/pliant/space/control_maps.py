"""How control points become the values that a tensor-product basis sums: repeated, followed by zeros, or filtered."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, kron

Floats = NDArray[np.float64]
Shares = tuple[Floats, Floats, Floats]


class ControlMap(Protocol):
    """How control points become the values that a basis sums, one axis at a time."""

    shape: tuple[int, int, int]

    def values(self, controls: Floats) -> Floats: ...
    def transpose(self, values: Floats) -> Floats: ...
    def shares(self, index: tuple[int, ...]) -> Shares: ...
    def matrix(self) -> csr_array: ...


class Padding:
    """How control points become the values that a basis sums: repeated or followed by zeros at the edges.

    Parameters
    ----------
    shape
        (3,) numbers of control points.
    sources
        For each axis, which control point each value is taken from; -1 for a zero.
    """

    def __init__(self, shape: tuple[int, int, int], sources: tuple[NDArray[np.int64], ...]) -> None:
        self.shape, self._sources = shape, sources
        self._plain = all(np.array_equal(s, np.arange(n)) for s, n in zip(sources, shape, strict=True))

    def values(self, controls: Floats) -> Floats:
        """(x, y, z, 3) what the basis sums, from (nx, ny, nz, 3)."""
        if self._plain:
            return np.ascontiguousarray(controls)
        for axis, source in enumerate(self._sources):
            controls = np.take(controls, np.maximum(source, 0), axis=axis)
            if (source < 0).any():
                controls[(slice(None),) * axis + (source < 0,)] = 0.0
        return np.ascontiguousarray(controls)

    def transpose(self, values: Floats) -> Floats:
        """(nx, ny, nz, 3) the transpose of :meth:`values`."""
        if self._plain:
            return values
        for axis, (source, count) in enumerate(zip(self._sources, self.shape, strict=True)):
            share = (source == np.arange(count)[:, None]).astype(np.float64)
            values = np.moveaxis(np.tensordot(share, values, axes=(1, axis)), 0, axis)
        return np.ascontiguousarray(values)

    def shares(self, index: tuple[int, ...]) -> Shares:
        """For each axis, 1 where a value is taken from that control point, else 0."""
        x, y, z = ((s == i).astype(np.float64) for s, i in zip(self._sources, index, strict=True))
        return x, y, z

    def matrix(self) -> csr_array:
        """(values, controls) the same as a sparse matrix."""
        i, j, k = self._sources[0][:, None, None], self._sources[1][None, :, None], self._sources[2][None, None, :]
        owner = np.where((i < 0) | (j < 0) | (k < 0), -1, (i * self.shape[1] + j) * self.shape[2] + k).reshape(-1)
        rows = np.flatnonzero(owner >= 0)
        shape = (len(owner), int(np.prod(self.shape)))
        return csr_array((np.ones(len(rows)), (rows, owner[rows])), shape=shape)


class Extraction:
    """As :class:`Padding`, by any matrix for each axis: a prefilter, a change of basis.

    Parameters
    ----------
    matrices
        For each axis, (values, control points).
    """

    def __init__(self, matrices: tuple[Floats, Floats, Floats]) -> None:
        self._matrices = matrices
        x, y, z = (matrix.shape[1] for matrix in matrices)
        self.shape = (x, y, z)

    def values(self, controls: Floats) -> Floats:
        """(x, y, z, 3) what the basis sums, from (nx, ny, nz, 3)."""
        return _along_axes(self._matrices, controls)

    def transpose(self, values: Floats) -> Floats:
        """(nx, ny, nz, 3) the transpose of :meth:`values`."""
        x, y, z = (matrix.T for matrix in self._matrices)
        return _along_axes((x, y, z), values)

    def shares(self, index: tuple[int, ...]) -> Shares:
        """For each axis, how much of that control point is in each value."""
        x, y, z = (matrix[:, i] for matrix, i in zip(self._matrices, index, strict=True))
        return x, y, z

    def matrix(self) -> csr_array:
        """(values, controls) the same as a sparse matrix."""
        x, y, z = (csr_array(matrix) for matrix in self._matrices)
        return csr_array(kron(kron(x, y), z))


def _along_axes(matrices: Shares, values: Floats) -> Floats:
    for axis, matrix in enumerate(matrices):
        values = np.moveaxis(np.tensordot(matrix, values, axes=(1, axis)), 0, axis)
    return np.ascontiguousarray(values)
