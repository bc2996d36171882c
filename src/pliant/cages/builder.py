"""Building a cage by hand: planes cut the shape, rings go around the cuts, links follow the limbs (Le & Deng 2017)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from pliant.cages.enclosing import Enclosing, spread, untangled
from pliant.cages.linking import Linking
from pliant.cages.parting import Parts, parted
from pliant.cages.relaxing import relaxed
from pliant.cages.sections import Cut
from pliant.errors import InvalidParameter, InvalidTarget, NotConverged
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.meshes.triangle_crossings import self_crossings

_FIRST = 4  # vertices between the rings of a region that is linked along the surface, at first
_MORE = 6  # that many each time where it fails, and there
_ATTEMPTS = 8
_PATIENCE = 2  # attempts for which rings and links may cut one another before the margin is made smaller
_SHARES = (1.0, 0.5, 0.25)  # of the margin, tried in turn: limbs may be near to one another


@dataclass(frozen=True, eq=False)
class CageBuilder:
    """A cage under construction; each step gives a new one.

    Planes cut the shape across its limbs. Around each cut lies a ring, a polygon of ``sides`` corners. Between two cuts
    the rings are linked by quadrangles, where three cuts or more meet by triangles, and a limb's end gets a cap. Which
    cuts meet follows from the mesh: it is the skeleton that the cuts imply. Then vertices are pushed out until the
    cage encloses the mesh, and made smoother and tighter while it does. A region where that fails, since the shape
    branches, bends or widens in it, is linked along the surface instead: further vertices are spread over it, and the
    surface says which belong together.

    Parameters
    ----------
    mesh
        What to enclose.
    sides
        Corners of each ring.
    margin
        Room between a section and its ring, in diagonals of the mesh.
    cuts
        The planes so far.
    """

    mesh: PolygonMesh
    sides: int = 6
    margin: float = 0.02
    cuts: tuple[Cut, ...] = ()

    def __post_init__(self) -> None:
        if not len(self.mesh.triangles) or not self.mesh.diagonal > 0:
            raise InvalidTarget("a cage is built around faces, and this mesh has none")
        if not 3 <= self.sides <= 64:
            raise InvalidParameter(f"sides is {self.sides}; it must be 3 to 64")
        if not 0 < self.margin <= 1:
            raise InvalidParameter(f"margin is {self.margin}; it must be positive, and at most 1, in diagonals")

    def cut(self, origin: ArrayLike, normal: ArrayLike) -> Self:
        """One more cut, of the limb around or nearest to the plane's origin.

        Parameters
        ----------
        origin, normal
            (3,) a point inside the limb, (3,) a direction along it, of any length.

        Raises
        ------
        InvalidParameter
            Numbers that are not finite, or a normal without length.
        """
        place, direction = np.asarray(origin, np.float64), np.asarray(normal, np.float64)
        for name, value in (("origin", place), ("normal", direction)):
            if value.shape != (3,) or not np.isfinite(value).all():
                raise InvalidParameter(f"the cut's {name} must be three finite numbers")
        length = float(np.linalg.norm(direction))
        if not length > 0:
            raise InvalidParameter("the cut's normal is zero: give a direction along the limb")
        return replace(self, cuts=(*self.cuts, Cut(place, direction / length)))

    def cuts_along(self, axis: str, count: int) -> Self:
        """Evenly spaced cuts across a coordinate axis, through the middle of each section.

        Parameters
        ----------
        axis
            ``"x"``, ``"y"`` or ``"z"``.
        count
            How many.

        Raises
        ------
        InvalidParameter
            No such axis.
        """
        if axis not in ("x", "y", "z"):
            raise InvalidParameter(f"axis is {axis!r}; it must be 'x', 'y' or 'z'")
        index = "xyz".index(axis)
        low, high = self.mesh.bounds
        result = self
        for part in (np.arange(count) + 0.5) / max(count, 1):
            origin = self.mesh.center.copy()
            origin[index] = low[index] + part * (high[index] - low[index])
            result = result.cut(origin, np.eye(3)[index])
        return result

    def rough(self) -> PolygonMesh:
        """Rings, links, branches and caps, before they enclose anything.

        Raises
        ------
        InvalidParameter, InvalidTarget
            No cut, one that misses the mesh or separates nothing, two that cross; pieces without a cut.
        """
        return self._linking(self._parted()).linked({})[0]

    def build(self, rounds: int = 3, *, progress: Callable[[float], object] = lambda _: None) -> PolygonMesh:
        """The cage.

        Regions whose faces do not enclose what is in them, or cut others, are linked along the surface, with more
        vertices each time.

        Parameters
        ----------
        rounds
            How often it is made smoother and tighter.
        progress
            Told how far it is, from 0 to 1, before each attempt; what it raises ends the work.

        Raises
        ------
        NotConverged
            No number of vertices that was tried gives a cage that encloses the mesh and does not cut itself: with the
            cuts around the regions where it fails, and a place.
        """
        parts, clearance = self._parted(), 0.1 * self.margin * self.mesh.diagonal
        regions = parts.of_vertices(len(self.mesh.points))
        for tried, share in enumerate(_SHARES):
            linking, places, near = self._linking(parts, share), dict[int, int](), dict[int, Points]()
            apart = False  # whether rings and links have been apart from one another
            for attempt in range(_ATTEMPTS):
                progress((tried + attempt / _ATTEMPTS) / len(_SHARES))
                linked, owners = linking.linked(places, near)
                rough = untangled(linked, self.mesh)
                crossed = self_crossings(rough.points, rough.triangles)
                if len(crossed):
                    triangles = np.unique(crossed)
                    wrong = rough.points[rough.triangles[triangles]].mean(axis=1)
                    at = owners[rough.triangle_faces[triangles]]
                    if attempt >= _PATIENCE and not apart and share != _SHARES[-1]:
                        break  # limbs are too near to one another for this margin
                else:
                    apart = True
                    points, wrong, at = Enclosing(rough, owners, self.mesh, regions, share * clearance).solve()
                if not len(wrong):
                    return relaxed(rough.with_points(points), self.mesh, rounds, clearance)
                for region in np.unique(at).tolist():
                    if region in places:
                        near[region] = np.concatenate([near.get(region, wrong[:0]), spread(wrong[at == region], _MORE)])
                    places[region] = places.get(region, 0) + _FIRST
        failing, (x, y, z) = linking.named(np.unique(at).tolist()), np.median(wrong, axis=0)
        raise NotConverged(
            f"the {len(self.cuts)} cuts give no cage that encloses the mesh without cutting itself: it fails at "
            f"{failing}, most of all near ({x:.4g}, {y:.4g}, {z:.4g}). Add cuts there or where the shape bends or "
            "widens, keep cuts of neighbouring limbs apart, or take a smaller margin"
        )

    def _parted(self) -> Parts:
        if not self.cuts:
            raise InvalidParameter("there is no cut yet: add one by cut(origin, normal)")
        return parted(self.mesh, self.cuts)

    def _linking(self, parts: Parts, share: float = 1.0) -> Linking:
        return Linking(parts, self.cuts, self.sides, share * self.margin * self.mesh.diagonal)
