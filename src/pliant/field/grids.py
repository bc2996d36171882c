"""Regular grids before and after a deformation: the picture of a map of R^3 since D'Arcy Thompson."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidParameter
from pliant.io.report import LossReport
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.given import as_numbers
from pliant.numerics.ragged import Ragged, frozen

AXES = "xyz"
MOST_POINTS = 50_000_000


@dataclass(frozen=True, eq=False)
class WarpedGrid:
    """The lines of a regular grid, and where a deformation takes them.

    Parameters
    ----------
    rest, points
        (n, 3) the lines' points before and after.
    lines
        Ragged rows of indices: one polyline a row.
    """

    rest: Points
    points: Points
    lines: Ragged

    def __post_init__(self) -> None:
        object.__setattr__(self, "rest", frozen(self.rest, np.float64))
        object.__setattr__(self, "points", frozen(self.points, np.float64))

    @property
    def displacement(self) -> Points:
        """(n, 3) how far each point went."""
        return self.points - self.rest

    @property
    def magnitude(self) -> NDArray[np.float64]:
        """(n,) the length of each displacement."""
        return np.asarray(np.linalg.norm(self.displacement, axis=1))

    def as_mesh(self) -> PolygonMesh:
        """A mesh of polylines, with the attribute ``"displacement"`` at its vertices."""
        return PolygonMesh(self.points, lines=self.lines, vertex_attributes={"displacement": self.displacement})

    def save(self, path: Path | str) -> LossReport:
        """Write the lines with their displacements.

        Parameters
        ----------
        path
            The ending says how: ``.vtp`` is VTK polydata.
        """
        from pliant.io.meshes import write

        return write(self.as_mesh(), path)


def field_grid(
    deformer: SpaceDeformer,
    bounds: tuple[ArrayLike, ArrayLike],
    spacing: float | ArrayLike,
    *,
    planes: Mapping[str, float | Sequence[float]] | None = None,
) -> WarpedGrid:
    """Deform a regular grid of lines.

    Parameters
    ----------
    deformer
        The map.
    bounds
        Lowest and highest corner of the grid, (3,) each.
    spacing
        Largest distance of neighbouring lines, one for all axes or one an axis, in the mesh's own unit. The lines
        fill the box evenly.
    planes
        Draw only planes: ``{"z": 0.0}`` the plane z = 0, ``{"x": [0, 1]}`` two. None = the grid fills the box.

    Returns
    -------
    WarpedGrid
        Lines divided so finely that no chord leaves its curve by more than 0.5 % of the spacing, as far as 32 pieces
        a cell allow.

    Raises
    ------
    InvalidParameter
        An empty box, a spacing that is not positive, an axis that is not x, y or z, more than 50 million points.
    """
    low, high = checked_box(bounds)
    steps = checked_spacing(spacing)
    ticks = [np.linspace(low[i], high[i], tick_count(low[i], high[i], steps[i])) for i in range(3)]
    tolerance = 0.005 * float(steps.min())
    for pieces in (4, 8, 16, 32):
        rest, lines = _sampled(ticks, pieces, planes)
        points = deformer(rest)
        if _chord_error(points, lines) <= tolerance:
            break
    return WarpedGrid(rest, points, lines)


def checked_box(bounds: tuple[ArrayLike, ArrayLike]) -> tuple[Points, Points]:
    """Both corners of a box as (3,) arrays.

    Raises
    ------
    InvalidParameter
        Another shape, corners that are not finite, or a highest corner below the lowest.
    """
    corners = as_numbers("bounds", bounds, InvalidParameter)
    if corners.shape != (2, 3) or not np.isfinite(corners).all() or (corners[0] > corners[1]).any():
        raise InvalidParameter(f"bounds are a lowest and a highest corner, (3,) each and finite; given: {bounds!r}")
    return corners[0], corners[1]


def checked_spacing(spacing: float | ArrayLike) -> Points:
    """(3,) positive distances from one number or three.

    Raises
    ------
    InvalidParameter
        Other shapes, or values that are not positive and finite.
    """
    given = as_numbers("spacing", spacing, InvalidParameter)
    if given.shape not in {(), (3,)} or not (np.isfinite(given) & (given > 0)).all():
        raise InvalidParameter(f"spacing is one positive number, or one an axis; given: {spacing!r}")
    return np.broadcast_to(given, (3,))


def tick_count(low: float, high: float, step: float) -> int:
    """How many positions fill an interval evenly, at most ``step`` apart.

    Raises
    ------
    InvalidParameter
        There would be more than 50 million.
    """
    cells = (high - low) / step
    if cells > MOST_POINTS:
        raise InvalidParameter(f"a spacing of {step:g} cuts an extent of {high - low:g} into {cells:.3g}: enlarge it")
    return int(np.ceil(cells * (1 - 1e-12))) + 1


def _sampled(
    ticks: list[Points], pieces: int, planes: Mapping[str, float | Sequence[float]] | None
) -> tuple[Points, Ragged]:
    """The grid's lines, each cell's edge cut into pieces."""
    runs = [(across, axis) for across in _sections(ticks, planes) for axis in range(3) if len(across[axis]) > 1]
    counts = [_bundle_shape(across, axis, pieces) for across, axis in runs]
    total = sum(lines * points for lines, points in counts)
    if total > MOST_POINTS:
        raise InvalidParameter(f"the grid would have {total:,} points: enlarge the spacing, or draw planes only")
    lengths = np.concatenate([np.empty(0, np.int64), *(np.full(lines, points) for lines, points in counts)])
    rest = np.concatenate([np.empty((0, 3)), *(_bundle(across, axis, pieces) for across, axis in runs)])
    return rest, Ragged(np.arange(len(rest), dtype=np.int32), np.concatenate([[0], np.cumsum(lengths)]))


def _sections(ticks: list[Points], planes: Mapping[str, float | Sequence[float]] | None) -> Iterator[list[Points]]:
    """The whole grid, or one flat grid a plane."""
    if planes is None:
        yield ticks
        return
    for name, places in planes.items():
        if name not in AXES or len(name) != 1:
            raise InvalidParameter(f"a plane is named by its axis, x, y or z; given: {name!r}")
        found = np.atleast_1d(as_numbers(f"planes[{name!r}]", places, InvalidParameter))
        if found.ndim != 1 or not np.isfinite(found).all():
            raise InvalidParameter(f"planes[{name!r}] is {places!r}; one finite number or several are needed")
        for place in found:
            yield [np.array([place]) if axis == AXES.index(name) else ticks[axis] for axis in range(3)]


def _bundle_shape(ticks: list[Points], axis: int, pieces: int) -> tuple[int, int]:
    """How many grid lines run along an axis, and how many points each has."""
    across = [len(ticks[i]) for i in range(3) if i != axis]
    return across[0] * across[1], (len(ticks[axis]) - 1) * pieces + 1


def _bundle(ticks: list[Points], axis: int, pieces: int) -> Points:
    """(lines × points, 3) the grid lines along one axis, one after another."""
    lines, points = _bundle_shape(ticks, axis, pieces)
    fine = list(ticks)
    fine[axis] = np.linspace(ticks[axis][0], ticks[axis][-1], points)
    bundle = np.stack(np.meshgrid(*fine, indexing="ij"), axis=-1)
    return np.moveaxis(bundle, axis, 2).reshape(lines * points, 3)


def _chord_error(points: Points, lines: Ragged) -> float:
    """How far the chords leave their curves, from second differences: an eighth of the largest."""
    if len(points) < 3:
        return 0.0
    inside = (lines.row_of[:-2] == lines.row_of[2:])[:, None]
    bend = (points[:-2] - 2 * points[1:-1] + points[2:]) * inside
    return float(np.linalg.norm(bend, axis=1).max()) / 8
