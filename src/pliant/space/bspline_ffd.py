"""Free-form deformation by a lattice of uniform cubic B-splines.

T(x) = A x + t + sum_ijk B_i(u) B_j(v) B_k(w) phi_ijk, the tensor product of Lee, Wolberg & Shin (1997), eq. 1, and
Rueckert et al. (1999), eq. 2. A control point reaches only the 4 x 4 x 4 cells around it.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Controls, Target
from pliant.errors import InvalidDeformer
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.numerics.given import as_numbers
from pliant.numerics.lattices.cells import BSPLINE, CellGrid, CellPoints, evaluate_once
from pliant.numerics.lattices.lattice_inverse import LatticeNewton
from pliant.numerics.lattices.polynomial_cells import PolynomialCells
from pliant.numerics.maps.newton import Solution, solve
from pliant.numerics.ragged import frozen
from pliant.space.box import box_around, checked_axes, checked_counts, thickened
from pliant.space.control_lattice import ControlLattice, spaced
from pliant.space.control_maps import Padding
from pliant.space.lattice import LatticeBinding

Floats = NDArray[np.float64]
Edge = Literal["clamp", "zero", "identity"]
Direction = Literal["push-forward", "pull-back"]

_LAYERS = {"clamp": 2, "zero": 3, "identity": 0}  # values beyond the lattice on each side that points can reach


@dataclass(frozen=True, eq=False, kw_only=True)
class BSplineFFD(ControlLattice):
    """Free-form deformation by a uniform cubic B-spline lattice (Lee, Wolberg & Shin 1997, eq. 1).

    Parameters
    ----------
    displacements
        (nx, ny, nz, 3) displacement of each control point, along the world's axes, in the mesh's unit. An axis with
        one control point is constant: (nx, ny, 1) is a planar lattice, a map of the plane into space.
    origin
        (3,) where control point (0, 0, 0) rests.
    spacing
        (3,) distance of the control points along each lattice axis.
    axes
        (3, 3) orthonormal; the columns are the lattice's axes.
    affine
        (4, 4) the global part, applied to positions before the displacement is added.
    edge
        What stands beyond the last control points: ``"clamp"`` their own displacement (translations are
        reproduced everywhere), ``"zero"`` none, ``"identity"`` nothing at all: where a point is not surrounded by
        4 x 4 x 4 control points, only the affine part moves it. The map then jumps one spacing inside the lattice.
    direction
        What the map is used for: ``"push-forward"`` moves points, ``"pull-back"`` says where a target's points come
        from, as registration files do. Calling it applies the map to points, either way.
    carrier
        What a reader kept in order to write the same file. Opaque.

    Raises
    ------
    InvalidDeformer
        Spacing that is not positive, axes that are not orthonormal, a singular affine part, values that are not
        finite.
    """

    displacements: Controls
    origin: Floats
    spacing: Floats
    axes: Floats = field(default_factory=lambda: np.eye(3))
    affine: Floats = field(default_factory=lambda: np.eye(4))
    edge: Edge = "clamp"
    direction: Direction = "push-forward"
    carrier: Any = None

    def __post_init__(self) -> None:
        values = {
            "displacements": _lattice_values(self.displacements),
            "origin": _vector(self.origin, "origin"),
            "spacing": _vector(self.spacing, "spacing"),
            "axes": checked_axes(self.axes),
            "affine": _affine(self.affine),
        }
        if not (values["spacing"] > 0).all():
            raise InvalidDeformer(f"lattice spacing must be positive; it is {values['spacing'].tolist()}")
        if self.edge not in _LAYERS:
            raise InvalidDeformer(f"edge is {self.edge!r}; it must be 'clamp', 'zero' or 'identity'")
        if self.edge == "identity" and min(values["displacements"].shape[:3]) < 4:
            raise InvalidDeformer(
                f"edge='identity' needs four control points an axis; the shape is {values['displacements'].shape[:3]}"
            )
        for name, value in values.items():
            object.__setattr__(self, name, frozen(value, np.float64))

    @classmethod
    def around(
        cls,
        target: PolygonMesh | ArrayLike,
        shape: tuple[int, int, int] = (4, 4, 4),
        margin: float = 0.0,
        axes: ArrayLike | None = None,
        edge: Edge = "clamp",
    ) -> BSplineFFD:
        """A lattice at rest that wraps a shape: the control points span its bounding box.

        Parameters
        ----------
        target
            A mesh or (n, 3) points.
        shape
            Numbers of control points along each axis; n points make n - 1 spans.
        margin
            How much to grow the box on every side, as a fraction of its extent along each axis.
        axes
            (3, 3) orthonormal columns, for a lattice that stands askew.
        edge
            What stands beyond the last control points.

        Raises
        ------
        InvalidDeformer
            An axis without control points, or axes that are not orthonormal.
        InvalidTarget
            No points.
        """
        frame = checked_axes(axes)
        counts = np.array(checked_counts(shape))
        origin, extent = box_around(target, frame, margin)
        thick = thickened(extent)
        middle = np.where((counts == 1) | (extent < thick), extent / 2 - thick * (counts > 1) / 2, 0.0)
        spacing = thick / np.maximum(counts - 1, 1)
        return cls(
            displacements=np.zeros((*counts, 3)), origin=origin + frame @ middle, spacing=spacing, axes=frame, edge=edge
        )

    @cached_property
    def rest(self) -> Controls:
        """(nx, ny, nz, 3) positions of the control points at rest."""
        return spaced(self.shape, self.origin, self.spacing, self.axes)

    def bind(self, target: Target) -> LatticeBinding:
        points = as_points(target)
        sampled, base = CellPoints(self._grid, points), frozen(self._base(points), np.float64)
        return LatticeBinding(sampled, self._padding, self.rest, self.displacements, base)

    def _deformed(self, target: Target) -> Points:
        points = as_points(target, borrow=True, finite=False)
        out = np.empty_like(points)
        values = self._padding.values(self.displacements)
        if not evaluate_once(self._grid, points, values, self._base(points), out):
            as_points(target)  # says which points are not finite
        return out

    def _base(self, points: Points) -> Points:
        """Where the points are while the lattice rests: the affine part."""
        if np.array_equal(self.affine, np.eye(4)):
            return points
        return points @ self.affine[:3, :3].T + self.affine[:3, 3]

    def jacobian(self, points: ArrayLike) -> Floats:
        sampled = CellPoints(self._grid, as_points(points))
        return sampled.jacobian(self._padding.values(self.displacements), np.ascontiguousarray(self.affine[:3, :3]))

    def _solved(self, images: Points, tolerance: float, iterations: int) -> Solution:
        fused = LatticeNewton(self._grid, self._padding.values(self.displacements), self.affine)
        return solve(self._deformed, self.jacobian, images, tolerance=tolerance, iterations=iterations, fused=fused)

    def refined(self) -> BSplineFFD:
        """The same map on half the spacing, exactly, by knot insertion (Lane & Riesenfeld 1980).

        Axes with one control point stay as they are. As the edge policy needs it, the finer lattice ends one layer
        ("clamp") or two ("zero") beyond the old ends, or one before them ("identity").
        """
        origin, spacing, values = self.origin.copy(), self.spacing.copy(), self.displacements
        for axis in range(3):
            if self.shape[axis] > 1:
                values, layers = _refine(values, axis, self.edge)
                spacing[axis] /= 2
                origin -= layers * spacing[axis] * self.axes[:, axis]
        return replace(self, displacements=values, origin=origin, spacing=spacing, carrier=None)

    def polynomial_cells(self) -> PolynomialCells:
        """The map cell by cell, as far as its support reaches: what proofs about it need."""
        values, grid = self._padding.values(self.displacements), self._grid
        inner = values[3:-3, 3:-3, 3:-3]  # with edge "identity" the map is continuous where only these move
        continuous = self.edge != "identity" or np.count_nonzero(inner) == np.count_nonzero(values)
        linear = np.ascontiguousarray(self.affine[:3, :3])
        return PolynomialCells(values, grid.frame, linear, (3, 3, 3), (1, 1, 1), splines=True, continuous=continuous)

    @cached_property
    def _layers(self) -> NDArray[np.int64]:
        """(3,) values beyond the lattice on each side; an axis with one control point is always constant."""
        return np.where(np.array(self.shape) == 1, _LAYERS["clamp"], _LAYERS[self.edge])

    @cached_property
    def _grid(self) -> CellGrid:
        counts = np.array(self.shape) + 2 * self._layers - 3
        frame = np.empty((3, 4))
        frame[:, :3] = self.axes.T / self.spacing[:, None]
        frame[:, 3] = self._layers - 1 - frame[:, :3] @ self.origin
        limits = np.stack([np.zeros(3), counts.astype(np.float64)])
        ends = (self._layers != _LAYERS["clamp"]) & (np.array(self.shape) > 1)
        keep = np.where(ends, limits, [[-np.inf], [np.inf]])  # beyond these edges nothing moves, exactly
        return CellGrid(frame, counts, 1, BSPLINE, limits, keep)

    @cached_property
    def _padding(self) -> Padding:
        sources = []
        for count, layers in zip(self.shape, self._layers, strict=True):
            source = np.arange(-layers, count + layers)
            beyond = (source < 0) | (source >= count)
            constant = self.edge == "clamp" or count == 1
            sources.append(np.clip(source, 0, count - 1) if constant else np.where(beyond, -1, source))
        return Padding(self.shape, tuple(sources))


def _refine(values: Floats, axis: int, edge: Edge) -> tuple[Floats, int]:
    """Control values along one axis on half the spacing, and how many layers stand before the old first one."""
    moved = np.moveaxis(values, axis, 0)
    width = [(2, 2)] + [(0, 0)] * (moved.ndim - 1)
    padded = np.pad(moved, width, mode="edge" if edge == "clamp" else "constant")
    knots = (padded[:-2] + 6 * padded[1:-1] + padded[2:]) / 8  # at the old control points -1 ... n
    middles = (padded[:-1] + padded[1:]) / 2  # between -2 and -1 ... n and n + 1
    fine = np.empty((2 * len(knots) - 1, *moved.shape[1:]))
    fine[0::2], fine[1::2] = knots, middles[1:-1]  # fine control points -2 ... 2 n
    layers = {"clamp": 1, "zero": 2, "identity": -1}[edge]
    return np.moveaxis(fine[2 - layers : len(fine) - 2 + layers], 0, axis), layers


def _lattice_values(values: ArrayLike) -> Floats:
    array = as_numbers("the lattice's displacements", values, InvalidDeformer)
    if array.ndim != 4 or array.shape[3] != 3 or 0 in array.shape:
        raise InvalidDeformer(f"lattice displacements have shape {array.shape}; (nx, ny, nz, 3) is needed")
    if not np.isfinite(array).all():
        raise InvalidDeformer(f"{(~np.isfinite(array)).any(axis=-1).sum()} control points are not finite")
    return array


def _vector(values: ArrayLike, name: str) -> Floats:
    array = as_numbers(f"the lattice's {name}", values, InvalidDeformer)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise InvalidDeformer(f"lattice {name} must be three finite numbers; it is {array.tolist()}")
    return array


def _affine(matrix: ArrayLike) -> Floats:
    array = as_numbers("the affine part", matrix, InvalidDeformer)
    if array.shape != (4, 4) or not np.isfinite(array).all() or not np.array_equal(array[3], [0, 0, 0, 1]):
        raise InvalidDeformer("the affine part must be a finite (4, 4) matrix with last row 0 0 0 1")
    if np.linalg.matrix_rank(array[:3, :3]) < 3:
        raise InvalidDeformer("the affine part is singular: it flattens space")
    return array
