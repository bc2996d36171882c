"""Deformation by a cage: a coarse closed mesh around a shape, whose vertices are the controls."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Controls, SpaceDeformer, Target, checked_controls
from pliant.errors import InvalidDeformer, OutsideDomain
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.numerics.coordinates.stretches import StretchedNormals
from pliant.space.cage_binding import CageBinding
from pliant.space.cage_structure import checked_cage
from pliant.space.coordinates.base import Coordinates
from pliant.space.coordinates.kinds import KINDS, coordinates_of
from pliant.space.coordinates.table import TableMaker, WeightTable, filled
from pliant.space.green_binding import GreenBinding

Kind = Literal["mean_value", "green", "harmonic", "maximum_entropy", "quad_mean_value", "quad_green"]
Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Cage(SpaceDeformer):
    """Deform what is inside a cage by moving its vertices.

    Parameters
    ----------
    mesh
        The cage at rest: closed, oriented outwards, not self-intersecting. Polygons are cut into triangles, but for
        the coordinates of quadrangles.
    coordinates
        ``"mean_value"``: smooth everywhere, affine maps are reproduced; some weights are negative in hollows.
        ``"green"``: nearly conformal, details turn with the cage's faces; similarities are reproduced, the cage is
        not interpolated, and the map is not linear in the controls. ``"harmonic"``: local, hardly ever negative.
        ``"maximum_entropy"``: never negative. ``"quad_mean_value"``, ``"quad_green"``: quadrangles are bilinear
        patches, no diagonal is preferred.
    positions
        (m, 3) where the cage's vertices are; None = at rest.
    outside
        Points outside the cage: ``"extend"``: mean value coordinates hold there as they are, Green coordinates are
        continued through the closest face, with others points follow the closest point of the cage;
        ``"keep"``: they stay where they are; ``"refuse"``: they are an error.
    levels
        How often the cage is cut finer for harmonic coordinates and for those of quadrangles, 0 to 3.
    precision
        ``"float64"`` or ``"float32"``: how a binding keeps weights; it computes in double precision all the same.
    threshold
        Weights below this are dropped, and kept weights sparse; 0 = keep all.

    Raises
    ------
    InvalidDeformer
        A cage that is open, inside out, degenerate, or cuts itself: with counts and the first place.
    OutsideDomain
        Points outside the cage, where ``outside="refuse"``.
    """

    mesh: PolygonMesh
    coordinates: Kind = "mean_value"
    positions: Controls | None = None
    outside: Literal["extend", "keep", "refuse"] = "extend"
    levels: int = 1
    precision: Literal["float64", "float32"] = "float64"
    threshold: float = 0.0

    def __post_init__(self) -> None:
        for name, value, known in (
            ("coordinates", self.coordinates, tuple(KINDS)),
            ("outside", self.outside, ("extend", "keep", "refuse")),
            ("precision", self.precision, ("float64", "float32")),
        ):
            if value not in known:
                raise InvalidDeformer(f"{name} is {value!r}; it must be one of {', '.join(map(repr, known))}")
        if self.levels not in (0, 1, 2, 3):
            raise InvalidDeformer(f"levels is {self.levels!r}; it must be 0, 1, 2 or 3")
        if not 0 <= self.threshold < 0.1:
            raise InvalidDeformer(f"threshold is {self.threshold}; it must be 0 or more, and below 0.1")
        if not isinstance(self.mesh, PolygonMesh):
            raise InvalidDeformer("a cage is a PolygonMesh: points alone enclose nothing")
        if self.positions is not None:
            given = np.array(checked_controls(self.positions, self.mesh.points.shape))
            given.flags.writeable = False
            object.__setattr__(self, "positions", given)
        checked_cage(self.mesh)

    @property
    def rest(self) -> Controls:
        """(m, 3) the cage's vertices."""
        return self.mesh.points

    @property
    def controls(self) -> Controls:
        return self.mesh.points if self.positions is None else self.positions

    @property
    def links(self) -> NDArray[np.int32]:
        """(e, 2) the cage's edges, for those who draw it."""
        return self.mesh.edges

    def moved(self, controls: ArrayLike) -> Self:
        other = replace(self, positions=checked_controls(controls, self.rest.shape))
        for name in ("_scheme", "_stretched"):
            if name in self.__dict__:
                other.__dict__[name] = self.__dict__[name]
        return other

    def bind(self, target: Target) -> CageBinding | GreenBinding:
        """Compute the weights of all points, once."""
        points = as_points(target)
        return self.bound(points, *self._tables(points))

    def bound(self, points: Points, vertices: WeightTable, faces: WeightTable | None) -> CageBinding | GreenBinding:
        """A binding from weights that are there already.

        Parameters
        ----------
        points
            (n, 3) the target's.
        vertices
            (n, v) weights of the cage's vertices.
        faces
            (n, t) weights of the stretched normals of its triangles; None = the coordinates have none.
        """
        if faces is None:
            return CageBinding(points, vertices, self.rest, self.controls)
        prolongation = self._scheme.prolongation
        return GreenBinding(points, (vertices, faces), self._stretched, prolongation, self.rest, self.controls)

    def jacobian(self, points: ArrayLike) -> Floats:
        """(n, 3, 3) the derivative; on the cage itself, where there are two, the one of the inside."""
        given = as_points(points, borrow=True)
        if not len(given):
            return np.empty((0, 3, 3))
        result = self._scheme.jacobian(given, self.controls - self.rest, self._pulls())
        if self.outside != "extend":
            result[self._beyond(self._scheme.places(given), len(given))] = np.eye(3)
        return result

    def _deformed(self, target: Target) -> Points:
        points = as_points(target)
        if self.threshold or self.precision != "float64":
            return self.bind(points).deform()
        moves, pulls, result = self.controls - self.rest, self._pulls(), np.empty_like(points)

        def rows(first: int, stop: int) -> list[Floats | None]:
            vertices, faces, place = self._rows(points[first:stop])
            beyond[first:stop] = place < 0
            result[first:stop] = points[first:stop] + vertices @ moves
            if faces is not None and pulls is not None:
                result[first:stop] += faces @ pulls
            return []

        beyond = np.zeros(len(points), bool)
        filled(len(points), self._scheme.piece, rows, [])
        self._judge(beyond)
        return result

    def _tables(self, points: Points) -> tuple[WeightTable, WeightTable | None]:
        """The weights of vertices and of faces."""
        scheme, count = self._scheme, len(points)
        beyond = np.zeros(count, bool)

        def rows(first: int, stop: int) -> list[Floats | None]:
            vertices, faces, place = self._rows(points[first:stop])
            beyond[first:stop] = place < 0
            return [vertices, faces]

        makers: list[TableMaker | None] = [TableMaker((count, len(self.rest)), self.precision, self.threshold), None]
        if self.coordinates in ("green", "quad_green"):
            makers[1] = TableMaker((count, len(scheme.surface.triangles)), self.precision, self.threshold)
        tables = filled(count, scheme.piece, rows, makers)
        self._judge(beyond)
        assert tables[0] is not None
        return tables[0], tables[1]

    def _rows(self, points: Points) -> tuple[Floats, Floats | None, NDArray[np.int8]]:
        """Rows in the unit of the cage; zero where points shall stay."""
        vertices, faces, place = self._scheme.rows(self._scheme.surface.scaled(points))
        if faces is not None:
            faces *= self._scheme.surface.scale
        if self.outside == "keep":
            vertices[place < 0] = 0.0
            if faces is not None:
                faces[place < 0] = 0.0
        return vertices, faces, place

    def _beyond(self, place: NDArray[np.int8], count: int) -> NDArray[np.bool_]:
        beyond = place < 0
        self._judge(beyond)
        return beyond

    def _judge(self, beyond: NDArray[np.bool_]) -> None:
        """Refuse points outside, where that is wanted."""
        if self.outside == "refuse" and beyond.any():
            raise OutsideDomain(
                f"{np.count_nonzero(beyond)} of {len(beyond):,} points are outside the cage, the first is point "
                f"{int(beyond.argmax())}: build a wider cage, or pass outside='extend' or 'keep'"
            )

    def _pulls(self) -> Floats | None:
        """(t, 3) what faces add, for coordinates that have weights for them."""
        if self.coordinates not in ("green", "quad_green"):
            return None
        fine = self._scheme.prolonged(np.asarray(self.controls))
        return self._stretched.at(fine) - self._stretched.at(self._scheme.prolonged(self.rest))

    @cached_property
    def _scheme(self) -> Coordinates:
        return coordinates_of(self.coordinates, self.mesh, self.levels)

    @cached_property
    def _stretched(self) -> StretchedNormals:
        return StretchedNormals(self._scheme.prolonged(self.rest), self._scheme.surface.triangles)
