"""A linear binding whose weights are a sparse matrix: controls anywhere, each reaching some points."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import LinearOperator, aslinearoperator

from pliant.deformer import Controls, Drag, LinearBinding, checked_controls, checked_out
from pliant.errors import InvalidControls
from pliant.mesh import Points

Indices = NDArray[np.int64]


class SparseBinding(LinearBinding):
    """x' = x + B E (c - c_rest), with sparse B and E.

    Parameters
    ----------
    points
        (n, 3) the target's.
    basis
        B (n, q): how much each point has of each of q values.
    expansion
        E (q, m): how the values follow from m controls; None = they are the controls.
    rest, displacements
        (m, 3) rest positions; the deformer's own displacements.
    """

    def __init__(
        self, points: Points, basis: csr_array, expansion: csr_array | None, rest: Controls, displacements: Controls
    ) -> None:
        self._points, self._basis, self._expansion = points, basis, expansion
        self._rest, self._displacements = rest, displacements
        self._columns: csc_array | None = None

    @property
    def rest(self) -> Controls:
        return self._rest

    @property
    def controls(self) -> Controls:
        return np.asarray(self._rest + self._displacements)

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        given = self._displacements if controls is None else checked_controls(controls, self._rest.shape) - self._rest
        target = checked_out(out, len(self._points))
        return np.add(self._points, self._apply(given), out=target)

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        return self._apply(checked_controls(d_controls, self._rest.shape))

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        pulled = self._basis.T @ checked_controls(d_points, self._points.shape)
        return np.asarray(pulled if self._expansion is None else self._expansion.T @ pulled)

    def drag(self, controls: ArrayLike | None = None) -> SparseDrag:
        return SparseDrag(self, controls)

    @property
    def weights(self) -> LinearOperator:
        """(n, m) W = B E, each coordinate alike."""
        basis = aslinearoperator(self._basis)
        return basis if self._expansion is None else basis @ aslinearoperator(self._expansion)

    def matrix(self) -> csr_array:
        """(n, m) W as a sparse matrix."""
        return self._basis if self._expansion is None else csr_array(self._basis @ self._expansion)

    def _values(self, displacements: Controls) -> Controls:
        """(q, 3) the values that follow from (m, 3) displacements."""
        return np.asarray(displacements if self._expansion is None else self._expansion @ displacements)

    def _apply(self, displacements: Controls) -> Points:
        return np.asarray(self._basis @ self._values(displacements))

    def _reached(self, controls: Indices) -> Indices:
        """The points that some controls reach."""
        if self._columns is None:
            self._columns = self._basis.tocsc()
        values = controls
        if self._expansion is not None:
            values = np.unique(self._expansion[:, controls].nonzero()[0])
        starts = self._columns.indptr
        runs = [self._columns.indices[starts[v] : starts[v + 1]] for v in values]
        return np.unique(np.concatenate([np.empty(0, np.int64), *runs])).astype(np.int64)


class SparseDrag(Drag):
    """A drag that recomputes the points that the moved controls reach, and no others."""

    _binding: SparseBinding

    def __init__(self, binding: SparseBinding, controls: ArrayLike | None = None) -> None:
        super().__init__(binding, controls)
        self._grabbed: tuple[tuple[int, ...], Indices, csr_array] | None = None

    def update(self, controls: ArrayLike, changed: Any = None) -> Indices:
        binding, new = self._binding, checked_controls(controls, self._controls.shape)
        moved = np.flatnonzero((new != self._controls).any(axis=1)) if changed is None else _rows(changed, len(new))
        if not len(moved):
            return np.empty(0, np.int64)
        chosen = tuple(moved.tolist())
        if self._grabbed is None or self._grabbed[0] != chosen:  # kept while the same ones are dragged
            rows = binding._reached(moved)
            self._grabbed = chosen, rows, binding._basis[rows]
        self._controls[moved] = new[moved]
        _, rows, basis = self._grabbed
        self._buffer[rows] = binding._points[rows] + basis @ binding._values(self._controls - binding._rest)
        return rows.copy()


def _rows(changed: Any, count: int) -> Indices:
    """(k,) control indices that the caller says have changed."""
    index = np.asarray(changed, np.int64).reshape(-1) if len(changed) else np.empty(0, np.int64)
    if ((index < 0) | (index >= count)).any():
        raise InvalidControls(f"a changed control {index.tolist()} is not among {count} controls")
    return np.unique(index)
