"""Rings linked region by region: tubes, branches and caps; where these do not do, along the surface itself."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from pliant.cages.clustering import clustered, collar
from pliant.cages.hulls import end_hull
from pliant.cages.parting import Parts
from pliant.cages.rings import Ring, branch, cap, polygon_around, tube
from pliant.cages.sections import Cut
from pliant.errors import InvalidParameter
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.ragged import Ragged

Indices = NDArray[np.int64]

_NONE = np.empty((0, 3))
_NOWHERE: Mapping[int, Points] = {}


@dataclass
class Linking:
    """A cage that is put together, a region at a time.

    Parameters
    ----------
    parts, cuts
        The regions, and the planes between them.
    sides, room
        Corners of each ring, and its distance from the section.
    """

    parts: Parts
    cuts: tuple[Cut, ...]
    sides: int
    room: float
    _points: list[Points] = field(default_factory=list)
    _faces: list[Ring] = field(default_factory=list)
    _owners: list[int] = field(default_factory=list)

    def linked(self, places: Mapping[int, int], near: Mapping[int, Points] = _NOWHERE) -> tuple[PolygonMesh, Indices]:
        """The cage, and (f,) the region of each face.

        Parameters
        ----------
        places
            For regions that are linked along the surface the number of places between their rings, at least.
        near
            (k, 3) where some of these shall be.

        Raises
        ------
        InvalidParameter
            A region that can be linked in no way.
        """
        around = [self.parts.points[rim] for rim in self.parts.rims]
        self._points = [
            polygon_around(each, cut, self.sides, self.room) for each, cut in zip(around, self.cuts, strict=True)
        ]
        self._faces, self._owners = [], []
        for region in np.unique(self.parts.sides).tolist():
            faces = self._region(region, places, near)
            if faces is None:
                raise InvalidParameter(f"{self.named([region])} cannot be linked: add a cut where it branches")
            self._faces += faces
            self._owners += [region] * len(faces)
        return PolygonMesh(np.concatenate(self._points), Ragged.of(self._faces)), np.array(self._owners)

    def named(self, regions: Iterable[int]) -> str:
        """Regions by the cuts around them."""
        return " and ".join(
            f"the region around cut{'s' * (len(numbers) > 1)} {', '.join(map(str, numbers))}"
            for numbers in map(self._cuts_of, regions)
        )

    def _region(self, region: int, places: Mapping[int, int], near: Mapping[int, Points]) -> list[Ring] | None:
        """Faces along the surface where that is wanted, else the fewest; in the other way where one does not do."""
        if region in places:
            return self._along_surface(region, places[region], near.get(region, _NONE)) or self._simple(region)
        return self._simple(region) or self._along_surface(region, 0, _NONE)

    def _simple(self, region: int) -> list[Ring] | None:
        """The fewest faces: a cap, a tube, or the hull of the rings; None where a ring is inside that."""
        numbers = self._cuts_of(region)
        rings = [self._ring(number, region) for number in numbers]
        if len(rings) == 1:
            return self._cap(region, numbers[0], rings[0])
        points = np.concatenate(self._points)
        return tube(points, *rings) if len(rings) == 2 else branch(points, rings)

    def _along_surface(self, region: int, wanted: int, near: Points) -> list[Ring] | None:
        """Faces between places that are spread over the region, or over the hull of a limb's end."""
        numbers, sides = self._cuts_of(region), self.sides
        points, triangles, rims = self._surface(region, numbers)
        count, collars, border = len(points), [triangles], []
        for at, number in enumerate(numbers):
            strip = collar(points, rims[at], self.cuts[number], sides, count + at * sides)
            collars.append(strip if self.parts.sides[number, 1] == region else strip[:, ::-1])
            around = at * sides + np.arange(sides)
            border.append(np.column_stack([around, np.roll(around, -1)]))
        corners = np.concatenate([number * sides + np.arange(sides) for number in numbers])
        points = np.concatenate([points, np.concatenate(self._points)[corners]])
        seeds = count + np.arange(len(corners))
        found = clustered(
            points,
            np.concatenate(collars),
            seeds,
            near,
            wanted,
            self.room,
            np.concatenate(border),
        )
        if found is None:
            return None
        first = sum(map(len, self._points))
        self._points.append(found.places)
        numbered = np.concatenate([corners, first + np.arange(len(found.places))])
        return [face.tolist() for face in numbered[found.faces]]

    def _surface(self, region: int, numbers: list[int]) -> tuple[Points, Indices, list[Indices]]:
        """What the faces of a region go along: points, triangles, and the rim at each cut."""
        parts = self.parts
        if len(numbers) == 1:
            below = region == parts.sides[numbers[0], 0]
            ring, cut = self._points[numbers[0]], self.cuts[numbers[0]]
            found = end_hull(ring, parts.inside(region), cut, bool(below), self.room)
            if found is not None:
                return found[0], found[1], [found[2]]
        return parts.points, parts.triangles[parts.region == region], [parts.rims[number] for number in numbers]

    def _cap(self, region: int, number: int, ring: Ring) -> list[Ring]:
        cut, below = self.cuts[number], region == self.parts.sides[number, 0]
        end = cap(ring, self.parts.inside(region), cut, cut.normal if below else -cut.normal, self.room)
        first = sum(map(len, self._points))
        self._points.append(end)
        last = list(range(first, first + self.sides))
        last = last if below else last[::-1]  # as the ring is
        after = [*range(1, self.sides), 0]
        links = [[last[i], last[j], ring[j], ring[i]] for i, j in enumerate(after)]
        return [*links, last[::-1]]

    def _cuts_of(self, region: int) -> list[int]:
        return np.flatnonzero((self.parts.sides == region).any(axis=1)).tolist()

    def _ring(self, number: int, region: int) -> Ring:
        ring = list(range(number * self.sides, (number + 1) * self.sides))
        return ring if self.parts.sides[number, 0] == region else ring[::-1]
