"""Free-form deformation by trivariate Bernstein polynomials (Sederberg & Parry 1986).

One hyperpatch of any degree, or a block of tricubic patches that share their faces' control points.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Controls, Target
from pliant.errors import InvalidDeformer, OutsideDomain
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.numerics.given import as_numbers
from pliant.numerics.lattices.bases import BernsteinPoints
from pliant.numerics.lattices.cells import BERNSTEIN, CellGrid, CellPoints
from pliant.numerics.lattices.lattice_inverse import LatticeNewton
from pliant.numerics.lattices.polynomial_cells import PolynomialCells
from pliant.numerics.maps.newton import Solution, solve
from pliant.numerics.ragged import frozen
from pliant.space.box import box_around, checked_axes, checked_counts, thickened
from pliant.space.control_lattice import ControlLattice, spread
from pliant.space.control_maps import Padding
from pliant.space.lattice import LatticeBinding

Floats = NDArray[np.float64]
Outside = Literal["identity", "extend", "error"]

TOLERANCE = 1e-9  # in parameters: a box's own corners must not fall outside it by rounding


@dataclass(frozen=True, eq=False, kw_only=True)
class BezierFFD(ControlLattice):
    """Free-form deformation of a parallelepiped by Bernstein polynomials.

    A point X = origin + s S + t T + u U has parameters (s, t, u) in [0, 1]^3 (Sederberg & Parry 1986, eq. 1); it
    moves by the Bernstein sum of the control points' displacements (eq. 3).

    Parameters
    ----------
    displacements
        (l + 1, m + 1, n + 1, 3) displacement of each control point, along the world's axes, in the mesh's unit.
    origin
        (3,) corner of the parallelepiped.
    edges
        (3, 3) the columns S, T, U: its edges, of any length and direction, as long as they span space.
    patches
        (3,) numbers of tricubic patches along the edges; the lattice then has 3 patches + 1 control points along
        each. None = one hyperpatch of whatever degree the lattice has.
    outside
        What happens to points outside the parallelepiped: ``"identity"`` they stay, ``"extend"`` the polynomials
        go on, ``"error"`` they are refused.

    Raises
    ------
    InvalidDeformer
        Edges that do not span space, a lattice that does not fit the patches, values that are not finite.
    """

    displacements: Controls
    origin: Floats
    edges: Floats
    patches: tuple[int, int, int] | None = None
    outside: Outside = "identity"

    def __post_init__(self) -> None:
        displacements = as_numbers("the lattice's displacements", self.displacements, InvalidDeformer)
        if displacements.ndim != 4 or displacements.shape[3] != 3 or 0 in displacements.shape:
            raise InvalidDeformer(f"lattice displacements have shape {displacements.shape}; (l, m, n, 3) is needed")
        origin = as_numbers("the lattice's origin", self.origin, InvalidDeformer)
        edges = as_numbers("the lattice's edges", self.edges, InvalidDeformer)
        if origin.shape != (3,) or edges.shape != (3, 3):
            raise InvalidDeformer(
                f"origin and edges have shapes {origin.shape}, {edges.shape}; (3,), (3, 3) are needed"
            )
        if not all(np.isfinite(array).all() for array in (displacements, origin, edges)):
            raise InvalidDeformer("the lattice has values that are not finite")
        lengths = np.linalg.norm(edges, axis=0)
        if not (lengths > 0).all() or abs(np.linalg.det(edges / lengths)) < 1e-12:
            raise InvalidDeformer(f"the lattice's edges do not span space: {edges.T.tolist()}")
        if self.patches is not None and displacements.shape[:3] != tuple(3 * p + 1 for p in self.patches):
            raise InvalidDeformer(
                f"{self.patches} tricubic patches have {tuple(3 * p + 1 for p in self.patches)} control points; "
                f"the lattice has {displacements.shape[:3]}"
            )
        if self.outside not in ("identity", "extend", "error"):
            raise InvalidDeformer(f"outside is {self.outside!r}; it must be 'identity', 'extend' or 'error'")
        for name, value in (("displacements", displacements), ("origin", origin), ("edges", edges)):
            object.__setattr__(self, name, frozen(value, np.float64))

    @classmethod
    def around(
        cls,
        target: PolygonMesh | ArrayLike,
        shape: tuple[int, int, int] | None = None,
        patches: tuple[int, int, int] | None = None,
        margin: float = 0.0,
        axes: ArrayLike | None = None,
        outside: Outside = "identity",
    ) -> BezierFFD:
        """A lattice at rest whose parallelepiped is a shape's bounding box.

        Parameters
        ----------
        target
            A mesh or (n, 3) points.
        shape
            Numbers of control points along each axis, the degrees plus one; (4, 4, 4) by default.
        patches
            Instead of ``shape``: numbers of tricubic patches along each axis.
        margin
            How much to grow the box on every side, as a fraction of its extent along each axis.
        axes
            (3, 3) orthonormal columns, for a box that stands askew.
        outside
            What happens to points outside the box.

        Raises
        ------
        InvalidDeformer
            A shape and patches at once, or an axis without control points.
        InvalidTarget
            No points.
        """
        if shape is not None and patches is not None:
            raise InvalidDeformer("give either a shape or numbers of patches: 3 patches + 1 is the shape")
        counts = checked_counts((4, 4, 4) if shape is None else shape)
        if patches is not None:
            counts = tuple(3 * count + 1 for count in checked_counts(patches))
        frame = checked_axes(axes)
        origin, extent = box_around(target, frame, margin)
        thick = thickened(extent)
        origin = origin + frame @ ((extent - thick) / 2)
        return cls(
            displacements=np.zeros((*counts, 3)), origin=origin, edges=frame * thick, patches=patches, outside=outside
        )

    @cached_property
    def rest(self) -> Controls:
        """(l + 1, m + 1, n + 1, 3) positions of the control points at rest (Sederberg & Parry 1986, eq. 2)."""
        return spread(self.shape, self.origin, self.edges)

    def moved_smoothly(self, moves: dict[tuple[int, int, int], ArrayLike]) -> Self:
        """Move control points of a block of patches, and with each those that keep the joints C1.

        Across a joint, a control point and its two neighbours are collinear and equally far apart. A point on a
        joint takes its neighbours along; a point beside a joint moves its mirror image across it the other way.

        Parameters
        ----------
        moves
            Displacement (3,) to add, by control point index (i, j, k).

        Raises
        ------
        InvalidDeformer
            One hyperpatch, which has no joints, or a control point that the lattice has not.
        """
        if self.patches is None:
            raise InvalidDeformer("one hyperpatch has no joints: use moved")
        displacements = self.displacements.copy()
        for index, step in moves.items():
            if any(not 0 <= i < n for i, n in zip(index, self.shape, strict=True)):
                raise InvalidDeformer(f"control point {index} is not in a lattice of shape {self.shape}")
            x, y, z = (_smooth_stencil(i, n) for i, n in zip(index, self.shape, strict=True))
            displacements += np.einsum("i,j,k,c->ijkc", x, y, z, np.asarray(step, np.float64))
        return replace(self, displacements=displacements)

    def free(self, continuity: int) -> NDArray[np.bool_]:
        """(l + 1, m + 1, n + 1) the control points that may move while the rim joins unmoved space with C^k.

        The ``continuity + 1`` outer layers are frozen (Sederberg & Parry 1986, sec. 3.4).

        Parameters
        ----------
        continuity
            k: 0 keeps the joint closed, 1 its tangents too.
        """
        mask = np.ones(self.shape, bool)
        for axis in range(3):
            layer = np.minimum(np.arange(self.shape[axis]), np.arange(self.shape[axis])[::-1])
            mask &= (layer > continuity).reshape([-1 if a == axis else 1 for a in range(3)])
        return mask

    def bind(self, target: Target) -> LatticeBinding:
        points = as_points(target)
        return LatticeBinding(self._sampled(points), self._padding, self.rest, self.displacements, points)

    def jacobian(self, points: ArrayLike) -> Floats:
        return self._sampled(as_points(points)).jacobian(self.displacements, np.eye(3))

    def polynomial_cells(self) -> PolynomialCells:
        """The map patch by patch: what proofs about it need."""
        x, y, z = (3, 3, 3) if self.patches else (n - 1 for n in self.shape)
        inner = self.displacements[self.free(0)]
        return PolynomialCells(
            self.displacements,
            self._frame,
            np.eye(3),
            degrees=(x, y, z),
            stride=(max(x, 1), max(y, 1), max(z, 1)),
            splines=False,
            whole=self.outside == "identity",
            continuous=self.outside == "identity" and np.count_nonzero(inner) == np.count_nonzero(self.displacements),
        )

    @property
    def _frame(self) -> Floats:
        """(3, 4) from positions to parameters, counted in patches."""
        inverse = np.linalg.inv(self.edges)
        frame = np.column_stack([inverse, -inverse @ self.origin])
        return np.asarray(frame * np.array([self.patches or (1, 1, 1)]).T)

    def _solved(self, images: Points, tolerance: float, iterations: int) -> Solution:
        fused = LatticeNewton(self._grid, self.displacements, np.eye(4)) if self._is_cubic else None
        return solve(self._deformed, self.jacobian, images, tolerance=tolerance, iterations=iterations, fused=fused)

    @property
    def _is_cubic(self) -> bool:
        return self.patches is not None or self.shape == (4, 4, 4)

    @property
    def _grid(self) -> CellGrid:
        """The patches as cells, where they are tricubic."""
        counts = np.array(self.patches or (1, 1, 1))
        everywhere = np.array([[-np.inf] * 3, [np.inf] * 3])
        return CellGrid(self._frame, counts, 3, BERNSTEIN, everywhere, self._keep)

    @property
    def _keep(self) -> Floats:
        """(2, 3) parameters, counted in patches, beyond which nothing moves."""
        beyond = np.inf if self.outside == "extend" else TOLERANCE
        return np.stack([np.full(3, -beyond), np.array(self.patches or (1, 1, 1)) + beyond])

    def _sampled(self, points: Points) -> CellPoints | BernsteinPoints:
        """The basis at some points: the sorted tricubic form wherever the patches are cubic."""
        sampled: CellPoints | BernsteinPoints
        if self._is_cubic:
            sampled = CellPoints(self._grid, points)
        else:
            sampled = BernsteinPoints(self.shape, self._frame, self._keep, points)
        if self.outside == "error":
            _refuse_outside(sampled, len(points))
        return sampled

    @property
    def _padding(self) -> Padding:
        x, y, z = (np.arange(n) for n in self.shape)
        return Padding(self.shape, (x, y, z))


def _smooth_stencil(index: int, count: int) -> Floats:
    """(count,) how a unit move of one control value moves its axis so that all inner joints stay C1."""
    stencil = np.zeros(count)
    stencil[index] = 1.0
    joint = 3 * round(index / 3)
    if 0 < joint < count - 1:
        if index == joint:
            stencil[joint - 1] = stencil[joint + 1] = 1.0
        else:
            stencil[2 * joint - index] = -1.0
    return stencil


def _refuse_outside(sampled: CellPoints | BernsteinPoints, count: int) -> None:
    outside = sampled.outside
    if len(outside):
        raise OutsideDomain(
            f"the lattice does not contain {len(outside):,} of {count:,} points, the first is point {outside.min()}: "
            "widen it with margin=, or pass outside='identity' or 'extend'"
        )
