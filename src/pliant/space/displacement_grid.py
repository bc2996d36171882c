"""A dense displacement field: an image whose voxels say how far space moves there."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Controls, Target
from pliant.errors import InvalidDeformer
from pliant.mesh import Points, as_points
from pliant.numerics.given import as_numbers
from pliant.numerics.lattices.cells import BSPLINE, CellGrid, CellPoints
from pliant.numerics.lattices.grid_points import GridPoints
from pliant.numerics.lattices.polynomial_cells import PolynomialCells
from pliant.numerics.ragged import frozen
from pliant.space.box import checked_axes
from pliant.space.control_lattice import ControlLattice, spaced
from pliant.space.control_maps import ControlMap, Extraction, Padding
from pliant.space.lattice import LatticeBinding

Floats = NDArray[np.float64]
Interpolation = Literal["linear", "cubic"]
Outside = Literal["identity", "clamp"]
Direction = Literal["push-forward", "pull-back"]


@dataclass(frozen=True, eq=False, kw_only=True)
class DisplacementGrid(ControlLattice):
    """Displacements at the nodes of a regular grid, interpolated in between.

    Its controls are the positions of the nodes.

    Parameters
    ----------
    displacements
        (nx, ny, nz, 3) displacement of each node, along the world's axes. An axis with one node is constant.
    origin
        (3,) where node (0, 0, 0) rests.
    spacing
        (3,) distance of the nodes along each axis of the grid.
    axes
        (3, 3) orthonormal; the columns are the grid's axes.
    interpolation
        ``"linear"``: trilinear, not differentiable on the planes through the nodes. ``"cubic"``: the cubic B-spline
        through the nodes, twice differentiable, with the field mirrored at its outermost nodes (Unser 1999, the
        boundary that ITK and SciPy's ``mode="mirror"`` have too).
    outside
        Beyond the grid: ``"identity"`` nothing moves, ``"clamp"`` the displacement of the nearest side.
    rim
        How far the grid reaches beyond its outermost nodes, in spacings; their displacements go on there. Images
        reach half a voxel beyond their voxels' centres.
    direction
        What the map is used for, as in :class:`~pliant.BSplineFFD`.
    carrier
        What a reader kept of its file. Opaque.

    Raises
    ------
    InvalidDeformer
        Spacing that is not positive, axes that are not orthonormal, values that are not finite, an unknown choice.
    """

    displacements: Controls
    origin: Floats
    spacing: Floats
    axes: Floats = field(default_factory=lambda: np.eye(3))
    interpolation: Interpolation = "linear"
    outside: Outside = "identity"
    rim: float = 0.0
    direction: Direction = "push-forward"
    carrier: Any = None

    def __post_init__(self) -> None:
        values = {
            **{
                name: as_numbers(f"the grid's {name}", getattr(self, name), InvalidDeformer)
                for name in ("displacements", "origin", "spacing")
            },
            "axes": checked_axes(self.axes),
        }
        shape = values["displacements"].shape
        if len(shape) != 4 or shape[3] != 3 or 0 in shape:
            raise InvalidDeformer(f"grid displacements have shape {shape}; (nx, ny, nz, 3) is needed")
        if values["origin"].shape != (3,) or values["spacing"].shape != (3,):
            raise InvalidDeformer("the grid's origin and spacing must be three numbers each")
        for name, value in values.items():
            flat = value.reshape(-1)
            if not np.isfinite(flat @ flat) and not np.isfinite(value).all():  # the product overflows, but is quick
                raise InvalidDeformer(
                    f"the grid's {name} hold {(~np.isfinite(value)).sum()} numbers that are not finite"
                )
        if not (values["spacing"] > 0).all():
            raise InvalidDeformer(f"grid spacing must be positive; it is {values['spacing'].tolist()}")
        if self.interpolation not in ("linear", "cubic") or self.outside not in ("identity", "clamp"):
            raise InvalidDeformer(
                f"interpolation={self.interpolation!r}, outside={self.outside!r}: there are 'linear' and 'cubic', "
                "'identity' and 'clamp'"
            )
        if not 0 <= self.rim < np.inf:
            raise InvalidDeformer(f"the rim is {self.rim} spacings wide; it must not be negative")
        for name, value in values.items():
            object.__setattr__(self, name, frozen(value, np.float64))

    @cached_property
    def rest(self) -> Controls:
        """(nx, ny, nz, 3) positions of the nodes at rest."""
        return spaced(self.shape, self.origin, self.spacing, self.axes)

    def bind(self, target: Target) -> LatticeBinding:
        points = as_points(target)
        return LatticeBinding(self._sampled(points), self._nodes, self.rest, self.displacements, points)

    def _deformed(self, target: Target) -> Points:
        points = as_points(target, borrow=True)
        out = np.empty_like(points)
        self._sampled(points).evaluate(self._values, points, out)
        return out

    def jacobian(self, points: ArrayLike) -> Floats:
        """(n, 3, 3) the derivative; linear grids have none on the planes through nodes: that of one side is given."""
        return self._sampled(as_points(points)).jacobian(self._values, np.eye(3))

    def is_smooth(self, points: ArrayLike, distance: float = 0.0) -> NDArray[np.bool_]:
        """(n,) whether the map is differentiable at (n, 3) points and ``distance`` around them.

        It is not on the planes through the nodes of a linear grid, nor at the rim.

        Parameters
        ----------
        points
            (n, 3) where.
        distance
            A length: how far around them too.
        """
        q = (as_points(points) - self.origin) @ self.axes / self.spacing
        last, room = np.array(self.shape) - 1.0, distance / self.spacing
        ends = [np.zeros(3), last]
        kinks = ends if self.interpolation == "cubic" else [np.clip(np.round(q), 0.0, last)]
        kinks = [np.where(last > 0, kink, np.inf) for kink in kinks]
        if self.outside == "identity":
            kinks += [np.full(3, -self.rim), last + self.rim]
        near = [(np.abs(q - kink) <= room).any(axis=1) for kink in kinks]
        return np.asarray(~np.any(near, axis=0))

    def polynomial_cells(self) -> PolynomialCells:
        """The map cell by cell, as far as displacements vary: what proofs about it need."""
        values, frame = self._values, self._frame
        inner = self.displacements[tuple(slice(1, -1) if n > 1 else slice(None) for n in self.shape)]
        continuous = self.outside == "clamp" or np.count_nonzero(inner) == np.count_nonzero(self.displacements)
        if self.interpolation == "cubic":
            cubic = PolynomialCells(values, frame, np.eye(3), (3, 3, 3), (1, 1, 1), splines=True)
            return replace(cubic, continuous=continuous)
        values = np.pad(values, [(1, 1)] * 3 + [(0, 0)], mode="edge")  # beyond the nodes slopes are others
        frame[:, 3] += 1
        linear = PolynomialCells(values, frame, np.eye(3), (1, 1, 1), (1, 1, 1), splines=False)
        return replace(linear, continuous=continuous)

    @property
    def _frame(self) -> Floats:
        """(3, 4) from positions to nodes, counted from 0."""
        frame = np.empty((3, 4))
        frame[:, :3] = self.axes.T / self.spacing[:, None]
        frame[:, 3] = -frame[:, :3] @ self.origin
        return frame

    def _sampled(self, points: Points) -> CellPoints | GridPoints:
        shape, frame = np.array(self.shape), self._frame
        reach = self.rim if self.outside == "identity" else np.inf
        keep = np.stack([np.full(3, -reach), shape - 1 + reach])
        if self.interpolation == "linear":
            nx, ny, nz = np.maximum(shape, 2).tolist()
            return GridPoints((nx, ny, nz), frame, keep, points)
        limits = np.stack([np.zeros(3), shape - 1.0])
        return CellPoints(CellGrid(frame, np.maximum(shape - 1, 1), 1, BSPLINE, limits, keep), points)

    @cached_property
    def _nodes(self) -> ControlMap:
        """From node displacements to what the basis sums."""
        if self.interpolation == "linear":
            i, j, k = (np.arange(max(n, 2)) % n for n in self.shape)
            return Padding(self.shape, (i, j, k))
        x, y, z = (_prefilter(n) for n in self.shape)
        return Extraction((x, y, z))

    @cached_property
    def _values(self) -> Floats:
        return self._nodes.values(self.displacements)


def _prefilter(count: int) -> Floats:
    """(count + 2, count) B-spline coefficients whose curve passes through given values (Unser 1999, eq. 11).

    Coefficients beyond the ends mirror those within.
    """
    if count == 1:
        return np.ones((4, 1))
    mirror = np.abs(np.arange(-1, count + 1))
    mirror = np.where(mirror >= count, 2 * (count - 1) - mirror, mirror)
    sums = np.zeros((count, count))
    for reach, weight in ((0, 1 / 6), (1, 4 / 6), (2, 1 / 6)):
        np.add.at(sums, (np.arange(count), mirror[reach : reach + count]), weight)
    return np.asarray(np.linalg.inv(sums)[mirror], np.float64)
