"""Free-form deformation by a box of clamped B-splines, as aerodynamic shape optimisation uses it.

A point of the box is embedded where the undeformed volume, whose control points are evenly spaced, passes through it;
moved control points then carry it along (Kenway, Kennedy & Martins 2010, "A CAD-free approach to high-fidelity
aerostructural optimization").
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Controls, Target
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.numerics.lattices.cells import BERNSTEIN, CellGrid, CellPoints
from pliant.numerics.lattices.clamped import parameters, pieces, spans
from pliant.space.bezier_ffd import TOLERANCE, BezierFFD
from pliant.space.control_lattice import ControlLattice, spread
from pliant.space.control_maps import Extraction, Shares
from pliant.space.lattice import LatticeBinding

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class ClampedFFD(ControlLattice):
    """Free-form deformation of a parallelepiped by clamped uniform B-splines of order min(4, n) along each axis.

    With up to four control points an axis it is a Bernstein lattice. Points outside the box stay (Kenway, Kennedy &
    Martins 2010).

    Parameters
    ----------
    displacements
        (nx, ny, nz, 3) displacement of each control point, along the world's axes.
    origin
        (3,) corner of the box.
    edges
        (3, 3) its columns are the box's edges, of any length and direction, as long as they span space.

    Raises
    ------
    InvalidDeformer
        Edges that do not span space, another shape, values that are not finite.
    """

    displacements: Controls
    origin: Floats
    edges: Floats

    def __post_init__(self) -> None:
        box = BezierFFD(displacements=self.displacements, origin=self.origin, edges=self.edges)  # the same checks
        for name in ("displacements", "origin", "edges"):
            object.__setattr__(self, name, getattr(box, name))

    @classmethod
    def around(
        cls, target: PolygonMesh | ArrayLike, shape: tuple[int, int, int] = (4, 4, 4), margin: float = 0.0
    ) -> ClampedFFD:
        """A lattice at rest whose box is a shape's bounding box.

        Parameters
        ----------
        target
            A mesh or (n, 3) points.
        shape
            How many control points there are along x, y and z.
        margin
            How much to grow the box on every side, as a part of its extent.
        """
        box = BezierFFD.around(target, shape=shape, margin=margin)
        return cls(displacements=box.displacements, origin=box.origin, edges=box.edges)

    @cached_property
    def rest(self) -> Controls:
        """(nx, ny, nz, 3) positions of the control points at rest, evenly spaced."""
        return spread(self.shape, self.origin, self.edges)

    def bind(self, target: Target) -> LatticeBinding:
        points = as_points(target)
        embedded = _Embedded(points, self.shape, self.origin, self.edges)
        return LatticeBinding(embedded, self._pieces, self.rest, self.displacements, points)

    def jacobian(self, points: ArrayLike) -> Floats:
        embedded = _Embedded(as_points(points), self.shape, self.origin, self.edges)
        return embedded.jacobian(self._pieces.values(self.displacements), np.eye(3))

    @cached_property
    def _pieces(self) -> Extraction:
        x, y, z = (pieces(n) for n in self.shape)
        return Extraction((x, y, z))


class _Embedded:
    """Points where the undeformed volume passes through them; the same questions as :class:`CellPoints`."""

    def __init__(self, points: Points, shape: tuple[int, int, int], origin: Floats, edges: Floats) -> None:
        self.points = points
        self._backward = np.linalg.inv(edges)
        t = (points - origin) @ self._backward.T
        found = [parameters(n, t[:, axis]) for axis, n in enumerate(shape)]
        self._slopes = np.stack([slope for _, slope in found], axis=1)
        counts = np.array([spans(n) for n in shape], np.int64)
        everywhere = np.array([[-np.inf] * 3, [np.inf] * 3])
        keep = np.stack([np.full(3, -TOLERANCE), counts + TOLERANCE])
        grid = CellGrid(np.eye(3, 4), counts, 3, BERNSTEIN, everywhere, keep)
        self._cells = CellPoints(grid, np.ascontiguousarray(np.stack([s for s, _ in found], axis=1)))

    @property
    def outside(self) -> NDArray[Any]:
        return self._cells.outside

    def evaluate(self, lattice: Floats, base: Floats, out: Floats) -> None:
        self._cells.evaluate(lattice, base, out)

    def jacobian(self, lattice: Floats, linear: Floats) -> Floats:
        """(n, 3, 3) by the chain rule: values by parameters, parameters by positions."""
        by_parameter = self._cells.jacobian(lattice, np.zeros((3, 3)))
        return np.asarray(linear + (by_parameter / self._slopes[:, None, :]) @ self._backward)

    def transpose(self, values: Floats) -> Floats:
        return self._cells.transpose(values)

    def column(self, selected: Shares) -> tuple[NDArray[np.int32], Floats]:
        return self._cells.column(selected)

    def basis_values(self) -> tuple[NDArray[np.int64], Floats]:
        return self._cells.basis_values()
