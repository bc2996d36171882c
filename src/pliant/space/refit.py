"""The nearest map of another kind, by least squares over a box, and how far it is off.

On a regular grid of samples the least-squares problem of a tensor-product basis falls apart into one small problem
for each axis, whose pseudo-inverses are applied one after another.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidParameter
from pliant.numerics.lattices.bases import bernstein
from pliant.numerics.lattices.cells import BERNSTEIN, BSPLINE
from pliant.numerics.lattices.clamped import parameters, pieces, spans
from pliant.space.affine import Affine
from pliant.space.bezier_ffd import BezierFFD
from pliant.space.bspline_ffd import BSplineFFD, Direction, Edge
from pliant.space.clamped_ffd import ClampedFFD
from pliant.space.control_maps import Extraction
from pliant.space.displacement_grid import DisplacementGrid
from pliant.space.region import Region
from pliant.space.sampling import to_grid

Floats = NDArray[np.float64]
Kind = Literal["bspline", "bernstein", "clamped", "grid", "affine"]
Shape = tuple[int, int, int]

_CHECKS = 20_000  # random points at which the result is compared
_MOST = 30_000_000  # samples
_HIGHEST = 24  # control points an axis, beyond which Bernstein polynomials are ill-conditioned


@dataclass(frozen=True, eq=False)
class Refit:
    """The nearest map of a kind.

    Parameters
    ----------
    deformer
        The map that was found.
    largest, rms
        How far its images are from the original's, at random points of the box.
    points
        Their number.
    """

    deformer: SpaceDeformer
    largest: float
    rms: float
    points: int

    def __str__(self) -> str:
        return (
            f"a {type(self.deformer).__name__} stands in its place, fitted by least squares: off by {self.largest:.3g} "
            f"at most, {self.rms:.3g} root mean square, at {self.points:,} points of the box"
        )


def refit(deformer: SpaceDeformer, kind: Kind, region: Region, shape: Shape, *, edge: Edge = "clamp") -> Refit:
    """The nearest map of a kind in a box.

    Parameters
    ----------
    deformer
        Any map of space that is defined in the box.
    kind
        ``"bspline"`` a lattice whose 4 x 4 x 4 neighbourhoods fill the box, ``"bernstein"`` and ``"clamped"`` lattices
        on the box, ``"grid"`` its displacements at nodes from side to side of the box, ``"affine"``.
    region
        The box.
    shape
        Numbers of control points or nodes along each axis of the box.
    edge
        What a B-spline lattice does beyond the box.

    Raises
    ------
    InvalidParameter
        Fewer control points than the kind needs, or more than can be solved for.
    """
    fit: dict[Kind, Callable[[], SpaceDeformer]] = {
        "bspline": lambda: _bspline(deformer, region, shape, edge),
        "bernstein": lambda: _boxed(deformer, region, shape, clamped=False),
        "clamped": lambda: _boxed(deformer, region, shape, clamped=True),
        "grid": lambda: _grid(deformer, region, shape),
        "affine": lambda: _affine(deformer, region),
    }
    found = fit[kind]()
    points = region.points(np.random.default_rng(0).random((_CHECKS, 3)))
    off = np.linalg.norm(found(points) - deformer(points), axis=1)
    return Refit(found, float(off.max()), float(np.sqrt((off**2).mean())), len(points))


def _bspline(deformer: SpaceDeformer, region: Region, shape: Shape, edge: Edge) -> BSplineFFD:
    if min(shape) < 4:
        raise InvalidParameter(f"a cubic B-spline lattice needs four control points an axis; {shape} are asked for")
    axes, lengths = region.frame()
    cells = np.array(shape) - 3
    spacing = lengths / cells
    samples = [np.linspace(0, 1, 2 * count + 3) for count in cells]
    rows = [_piecewise(BSPLINE, 1, count, t * count) for count, t in zip(cells, samples, strict=True)]
    values = _solved(deformer, region, samples, rows)
    origin = region.origin - axes @ spacing
    direction: Direction = getattr(deformer, "direction", "push-forward")
    return BSplineFFD(displacements=values, origin=origin, spacing=spacing, axes=axes, edge=edge, direction=direction)


def _boxed(deformer: SpaceDeformer, region: Region, shape: Shape, *, clamped: bool) -> SpaceDeformer:
    if min(shape) < 2:
        raise InvalidParameter(f"a lattice on a box needs two control points an axis; {shape} are asked for")
    if not clamped and max(shape) > _HIGHEST:
        raise InvalidParameter(
            f"Bernstein lattices of more than {_HIGHEST} control points an axis cannot be fitted well"
        )
    samples = [(1 - np.cos(np.linspace(0, np.pi, 2 * n + 1))) / 2 for n in shape]
    if clamped:
        rows = [
            _piecewise(BERNSTEIN, 3, spans(n), parameters(n, t)[0]) @ pieces(n)
            for n, t in zip(shape, samples, strict=True)
        ]
    else:
        rows = [bernstein(n - 1, t) for n, t in zip(shape, samples, strict=True)]
    values = _solved(deformer, region, samples, rows)
    kind = ClampedFFD if clamped else BezierFFD
    return kind(displacements=values, origin=region.origin, edges=region.edges)


def _piecewise(basis: Floats, stride: int, cells: int, q: Floats) -> Floats:
    """(k, values) cubic basis functions of an axis at (k,) places counted in cells."""
    cell = np.clip(np.floor(q), 0, cells - 1).astype(np.int64)
    rows = np.zeros((len(q), stride * (cells - 1) + 4))
    np.put_along_axis(rows, cell[:, None] * stride + np.arange(4), (q - cell)[:, None] ** np.arange(4) @ basis, axis=1)
    return rows


def _solved(deformer: SpaceDeformer, region: Region, samples: list[Floats], rows: list[Floats]) -> Floats:
    """Control values from the displacements at a grid of samples."""
    count = int(np.prod([len(t) for t in samples]))
    if count > _MOST:
        raise InvalidParameter(f"so fine a lattice needs {count:,} samples: take fewer control points")
    parameter = np.stack(np.meshgrid(*samples, indexing="ij"), axis=-1)
    points = region.points(parameter.reshape(-1, 3))
    displacements = (deformer(points) - points).reshape(parameter.shape)
    x, y, z = (np.asarray(np.linalg.pinv(row), np.float64) for row in rows)
    return Extraction((x, y, z)).values(displacements)


def _grid(deformer: SpaceDeformer, region: Region, shape: Shape) -> DisplacementGrid:
    if min(shape) < 2:
        raise InvalidParameter(f"a grid needs two nodes an axis; {shape} are asked for")
    axes, _ = region.frame()
    return to_grid(deformer, region.points(np.array([[0, 0, 0], [1, 1, 1.0]])), shape=shape, axes=axes)


def _affine(deformer: SpaceDeformer, region: Region) -> Affine:
    points = region.points(np.stack(np.meshgrid(*[np.linspace(0, 1, 17)] * 3), axis=-1).reshape(-1, 3))
    middle = points.mean(axis=0)
    rows = np.column_stack([points - middle, np.ones(len(points))])
    solution = np.linalg.lstsq(rows, deformer(points), rcond=None)[0]
    return Affine.of(solution[:3].T, solution[3] - solution[:3].T @ middle)
