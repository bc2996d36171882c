"""Points bound to a cage by Green coordinates: weights of its vertices and of its faces' stretched normals."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from pliant.deformer import Controls, checked_controls, checked_out, require_finite
from pliant.mesh import Points
from pliant.numerics.coordinates.stretches import StretchedNormals
from pliant.space.cage_binding import CageDrag
from pliant.space.coordinates.table import WeightTable
from pliant.space.point_binding import PointBinding

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


class GreenBinding(PointBinding):
    """x' = x + phi (c - c_rest) + psi (N(c) - N(c_rest)), where N are the faces' normals times their stretches.

    It is not linear: a face's normal turns with its vertices.

    Parameters
    ----------
    points
        (n, 3) the target's.
    tables
        (n, m) phi and (n, t) psi.
    normals
        N of (p, 3) positions.
    prolongation
        (p, m) how the vertices of the faces follow from the cage's; None = they are the cage's.
    rest, controls
        (m, 3) the cage's vertices at rest; where they were when it was bound.
    """

    def __init__(
        self,
        points: Points,
        tables: tuple[WeightTable, WeightTable],
        normals: StretchedNormals,
        prolongation: csr_array | None,
        rest: Controls,
        controls: Controls,
    ) -> None:
        super().__init__(points, rest, controls)
        self.tables, self._normals, self._prolongation = tables, normals, prolongation
        self._rest_normals = normals.at(self._prolonged(rest))

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        given = self._checked(controls)
        target = checked_out(out, len(self._points))
        np.add(self._points, self.tables[0].apply(given - self._rest), out=target)
        target += self.tables[1].apply(self._normals.at(self._prolonged(given)) - self._rest_normals)
        return require_finite(target, "cage")

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        change = checked_controls(d_controls, self._rest.shape)
        fine, fine_change = self._prolonged(self._checked(controls)), self._prolonged(change)
        return self.tables[0].apply(change) + self.tables[1].apply(self._normals.pushed(fine, fine_change))

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        gradient = checked_controls(d_points, self._points.shape)
        fine = self._prolonged(self._checked(controls))
        pulled = self._normals.pulled(fine, self.tables[1].transposed(gradient))
        back = pulled if self._prolongation is None else np.asarray(self._prolongation.T @ pulled)
        return self.tables[0].transposed(gradient) + back

    def drag(self, controls: ArrayLike | None = None) -> CageDrag:
        return CageDrag(self, controls)

    def step(self, chosen: Indices, before: Controls, after: Controls, kept: Any) -> tuple[Points, Any]:
        """(n, 3) what moving some controls adds: their columns, and those of the faces that they stretch."""
        if kept is None:
            faces = self._faces_at(chosen)
            kept = faces, self.tables[0].columns(chosen), self.tables[1].columns(faces)
        faces, columns, face_columns = kept
        now, then = (self._normals.at(self._prolonged(each), faces) for each in (after, before))
        return columns @ (after[chosen] - before[chosen]) + face_columns @ (now - then), kept

    def _prolonged(self, values: Controls) -> Floats:
        return values if self._prolongation is None else np.asarray(self._prolongation @ values)

    def _faces_at(self, chosen: Indices) -> Indices:
        """The faces that use a control, or what follows from it."""
        touched = np.zeros(len(self._rest))
        touched[chosen] = 1.0
        reached = touched if self._prolongation is None else self._prolongation @ touched
        return np.flatnonzero((reached[self._normals.triangles] > 0).any(axis=1))
