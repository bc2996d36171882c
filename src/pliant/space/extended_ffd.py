"""Free-form deformation by lattices of other shapes than boxes (Coquillart 1990).

A lattice is made of blocks of tricubic patches; places in blocks share control points: around an axis, where edges
are collapsed, and where blocks meet. A point's parameters are those at which the lattice at rest passes through it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from pliant.deformer import Controls, SpaceDeformer, Target, checked_controls
from pliant.errors import InvalidDeformer, OutsideDomain
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.numerics.given import as_numbers
from pliant.numerics.lattices.patch_block import PatchBlock
from pliant.numerics.ragged import frozen
from pliant.space import round_lattices
from pliant.space.round_lattices import RoundFrame
from pliant.space.smooth_joints import smooth_moves
from pliant.space.sparse import SparseBinding

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

SINGULAR = 1e-5  # volume of the lattice's parameter axes, relative to their lengths, below which none can be trusted


class ExtendedBinding(SparseBinding):
    """Points with their parameters in the lattice; 64 weights each."""

    def __init__(self, points: Points, basis: csr_array, rest: Controls, displacements: Controls, outside: Integers):
        super().__init__(points, basis, None, rest, displacements)
        self._outside = outside

    @property
    def outside(self) -> Integers:
        """The points that the lattice does not contain, ascending; they stay."""
        return self._outside


@dataclass(frozen=True, eq=False, kw_only=True)
class ExtendedFFD(SpaceDeformer):
    """Free-form deformation by a composite lattice of tricubic patches (Coquillart 1990).

    Parameters
    ----------
    points
        (m, 3) control points at rest, each once.
    blocks
        How the control points make blocks; see :class:`pliant.numerics.lattices.patch_block.PatchBlock`.
    displacements
        (m, 3) displacement of each control point; None = at rest.
    outside
        What happens to points that no block contains: ``"identity"`` they stay, ``"error"`` they are refused.
    frames
        For each block where it stands if it is a round one at rest, which makes binding faster; else None.

    Raises
    ------
    InvalidDeformer
        A block that uses a control point that is not there, or values that are not finite.
    """

    points: Controls
    blocks: tuple[PatchBlock, ...]
    displacements: Controls | None = None
    outside: Literal["identity", "error"] = "identity"
    frames: tuple[RoundFrame | None, ...] | None = None

    def __post_init__(self) -> None:
        points = as_numbers("points", self.points, InvalidDeformer)
        if points.ndim != 2 or points.shape[1] != 3:
            raise InvalidDeformer(f"control points have shape {points.shape}; (m, 3) is needed")
        moves = (
            np.zeros_like(points)
            if self.displacements is None
            else as_numbers("displacements", self.displacements, InvalidDeformer)
        )
        if moves.shape != points.shape:
            raise InvalidDeformer(f"displacements have shape {moves.shape}; {points.shape} is needed")
        if not (np.isfinite(points).all() and np.isfinite(moves).all()):
            raise InvalidDeformer("the lattice has control points that are not finite")
        if self.outside not in ("identity", "error"):
            raise InvalidDeformer(f"outside is {self.outside!r}; it must be 'identity' or 'error'")
        for at, block in enumerate(self.blocks):
            if block.index.ndim != 3 or block.index.min() < 0 or block.index.max() >= len(points):
                raise InvalidDeformer(f"block {at} uses control points that are not among the {len(points)}")
            if len(block.bases) != 3 or len(block.wrapped) != 3 or not set(block.bases) <= {"bezier", "bspline"}:
                raise InvalidDeformer(f"block {at} needs a basis an axis, 'bezier' or 'bspline', and whether it wraps")
        object.__setattr__(self, "points", frozen(points, np.float64))
        object.__setattr__(self, "displacements", frozen(moves, np.float64))
        object.__setattr__(self, "frames", self.frames or (None,) * len(self.blocks))

    @classmethod
    def cylinder(
        cls,
        target: PolygonMesh | ArrayLike,
        axis: str = "z",
        shape: tuple[int, int, int] = (8, 4, 4),
        margin: float = 0.05,
        outside: Literal["identity", "error"] = "identity",
    ) -> ExtendedFFD:
        """A cylinder at rest that wraps a shape.

        Parameters
        ----------
        target
            A mesh or (n, 3) points; the cylinder is as much wider than deep as its bounding box is.
        axis
            ``"x"``, ``"y"`` or ``"z"``.
        shape
            Control points around, from the axis outwards, and along the axis: 5 or more, and twice 4, 7, 10 ...
        margin
            How much to grow the cylinder, as a part of its size.
        outside
            What happens to points outside the lattice.
        """
        return cls._round(round_lattices.cylinder(target, axis, shape, margin), outside)

    @classmethod
    def prism(
        cls,
        target: PolygonMesh | ArrayLike,
        axis: str = "z",
        sides: int = 6,
        shape: tuple[int, int] = (4, 4),
        margin: float = 0.05,
        outside: Literal["identity", "error"] = "identity",
    ) -> ExtendedFFD:
        """A prism at rest that wraps a shape.

        Parameters
        ----------
        target, axis, margin, outside
            As in :meth:`cylinder`.
        sides
            How many flat sides it has.
        shape
            Control points from the axis outwards, and along it: 4, 7, 10 ...
        """
        return cls._round(round_lattices.prism(target, axis, sides, shape, margin), outside)

    @classmethod
    def sphere(
        cls,
        target: PolygonMesh | ArrayLike,
        axis: str = "z",
        shape: tuple[int, int, int] = (8, 4, 7),
        margin: float = 0.05,
        outside: Literal["identity", "error"] = "identity",
    ) -> ExtendedFFD:
        """A sphere, or an ellipsoid, at rest that wraps a shape.

        Parameters
        ----------
        target, axis, margin, outside
            As in :meth:`cylinder`.
        shape
            Control points around, from the middle outwards, and from pole to pole.
        """
        return cls._round(round_lattices.sphere(target, axis, shape, margin), outside)

    @classmethod
    def _round(cls, made: tuple[Floats, PatchBlock, RoundFrame], outside: Literal["identity", "error"]) -> ExtendedFFD:
        points, block, frame = made
        return cls(points=points, blocks=(block,), frames=(frame,), outside=outside)

    @property
    def rest(self) -> Controls:
        """(m, 3) the control points at rest."""
        return self.points

    @property
    def controls(self) -> Controls:
        return np.asarray(self.points + self._moves)

    @property
    def links(self) -> Integers:
        """(e, 2) pairs of control points that are neighbours in the lattice."""
        pairs = [pair for block in self.blocks for pair in block.links()]
        return np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0)

    def moved(self, controls: ArrayLike) -> Self:
        return replace(self, displacements=checked_controls(controls, self.points.shape) - self.points)

    def with_rest(self, points: ArrayLike) -> Self:
        """The same lattice with its (m, 3) control points at rest elsewhere, and not displaced.

        Parameters
        ----------
        points
            (m, 3) where they rest.

        Raises
        ------
        InvalidControls
            Another shape, or numbers that are not finite.
        """
        rest = checked_controls(points, self.points.shape)
        return replace(self, points=rest, displacements=None, frames=None)

    def moved_smoothly(self, moves: dict[int, ArrayLike]) -> Self:
        """Move control points, and with each those that keep Bézier joints C1, also where blocks meet.

        Parameters
        ----------
        moves
            Displacement (3,) to add, by control point.

        Raises
        ------
        InvalidDeformer
            A control point that the lattice has not.
        """
        wrong = [index for index in moves if not 0 <= index < len(self.points)]
        if wrong:
            raise InvalidDeformer(f"control point {wrong[0]} is not among the {len(self.points)}")
        displacements = self._moves.copy()
        for index, step in moves.items():
            for other, share in smooth_moves(self.points, self.blocks, index).items():
                displacements[other] += share * np.asarray(step, np.float64)
        return replace(self, displacements=displacements)

    def bind(self, target: Target) -> ExtendedBinding:
        points = as_points(target)
        rows, columns, values = [], [], []
        found, outside = self._parameters(points)
        for block, (at, parameters) in zip(self.blocks, found, strict=True):
            places, shares = block.basis_values(parameters)
            rows.append(np.repeat(at, 64))
            columns.append(places.reshape(-1))
            values.append(shares.reshape(-1))
        parts = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        basis = csr_array(parts, shape=(len(points), len(self.points)))
        basis.sum_duplicates()
        return ExtendedBinding(points, basis, self.points, self._moves, outside)

    def jacobian(self, points: ArrayLike) -> Floats:
        """(n, 3, 3) by the chain rule, dX/dq (dS/dq)^-1; by finite differences where the lattice is collapsed."""
        at = as_points(points)
        result = np.tile(np.eye(3), (len(at), 1, 1))
        for block, (inside, parameters) in zip(self.blocks, self._parameters(at)[0], strict=True):
            _, moved = block.differentiate(self._moves, parameters)
            _, rest = block.differentiate(self.points, parameters)
            lengths = np.linalg.norm(rest, axis=1)
            longest = lengths.max(axis=1, initial=1e-300)[:, None]
            regular = np.abs(np.linalg.det(rest / longest[:, None])) > SINGULAR
            regular &= (lengths > 1e-6 * longest).all(axis=1)
            good = inside[regular]
            result[good] += moved[regular] @ np.linalg.inv(rest[regular])
            result[inside[~regular]] = self._differences(at[inside[~regular]])
        return result

    def _differences(self, points: Points) -> Floats:
        """(n, 3, 3) central differences of fourth order."""
        step = 1e-4 * float(np.linalg.norm(np.ptp(self.points, axis=0)))
        result = np.empty((len(points), 3, 3))
        for axis in range(3):
            h = step * np.eye(3)[axis]
            near = self._deformed(points + h) - self._deformed(points - h)
            result[:, :, axis] = (8 * near - self._deformed(points + 2 * h) + self._deformed(points - 2 * h)) / 12
        return result / step

    def _parameters(self, points: Points) -> tuple[list[tuple[Integers, Floats]], Integers]:
        """For each block the points in it, none twice, and their parameters; and the points in none."""
        assert self.frames is not None
        left, found = np.arange(len(points)), []
        for block, frame in zip(self.blocks, self.frames, strict=True):
            here = points[left]
            parameters, inside = block.parameters(self.points, here, None if frame is None else frame.seeds(here))
            found.append((left[inside], parameters))
            left = np.delete(left, inside)
        if len(left) and self.outside == "error":
            raise OutsideDomain(
                f"the lattice does not contain {len(left):,} of {len(points):,} points, the first is point {left[0]} "
                f"at {points[left[0]]}: widen it with margin=, or pass outside='identity'"
            )
        return found, left

    @property
    def _moves(self) -> Controls:
        assert self.displacements is not None
        return self.displacements
