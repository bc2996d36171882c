"""Points bound to a cage by weights of its vertices."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse.linalg import LinearOperator, aslinearoperator

from pliant.deformer import Controls, Drag, LinearBinding, checked_controls, checked_out, require_finite
from pliant.mesh import Points
from pliant.space.coordinates.table import WeightTable
from pliant.space.point_binding import PointBinding
from pliant.space.sparse import _rows as changed_rows

Indices = NDArray[np.int64]


class CageBinding(PointBinding, LinearBinding):
    """x' = x + W (c - c_rest).

    Parameters
    ----------
    points
        (n, 3) the target's.
    table
        (n, m) W.
    rest, controls
        (m, 3) the cage's vertices at rest; where they were when it was bound.
    """

    def __init__(self, points: Points, table: WeightTable, rest: Controls, controls: Controls) -> None:
        super().__init__(points, rest, controls)
        self.table = table

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        target = checked_out(out, len(self._points))
        np.add(self._points, self.table.apply(self._checked(controls) - self._rest), out=target)
        return require_finite(target, "cage")

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        return self.table.apply(checked_controls(d_controls, self._rest.shape))

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        return self.table.transposed(checked_controls(d_points, self._points.shape))

    def drag(self, controls: ArrayLike | None = None) -> CageDrag:
        return CageDrag(self, controls)

    @property
    def weights(self) -> LinearOperator:
        """(n, m) W, each coordinate alike."""
        return aslinearoperator(self.table.matrix)

    def matrix(self) -> Any:
        """(n, m) W as it is kept: a dense array, or a sparse one."""
        return self.table.matrix

    def step(self, chosen: Indices, before: Controls, after: Controls, kept: Any) -> tuple[Points, Any]:
        """(n, 3) what moving some controls adds, and what to keep for the next such step: their columns."""
        columns = self.table.columns(chosen) if kept is None else kept
        return columns @ (after[chosen] - before[chosen]), columns


class CageDrag(Drag):
    """A drag that reads the columns of the controls that move, and no others.

    Steps are taken from where the present grip began, so that rounding does not add up.
    """

    _binding: Any

    def __init__(self, binding: Any, controls: ArrayLike | None = None) -> None:
        super().__init__(binding, controls)
        self._grip: tuple[int, ...] = ()
        self._from, self._base, self._kept = self._controls.copy(), self._buffer, None

    def update(self, controls: ArrayLike, changed: Any = None) -> Indices:
        new = checked_controls(controls, self._controls.shape)
        moved = (
            np.flatnonzero((new != self._controls).any(axis=1)) if changed is None else changed_rows(changed, len(new))
        )
        if not len(moved):
            return np.empty(0, np.int64)
        grip = tuple(moved.tolist())
        if grip != self._grip:
            self._grip, self._kept = grip, None
            self._from, self._base = self._controls.copy(), self._buffer.copy()
        self._controls[moved] = new[moved]
        step, self._kept = self._binding.step(moved, self._from, self._controls, self._kept)
        before = self._buffer.copy()
        np.add(self._base, step, out=self._buffer)
        return np.flatnonzero((before != self._buffer).any(axis=1))
