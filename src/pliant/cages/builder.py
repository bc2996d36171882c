"""Building a cage by hand: planes cut the shape, rings go around the cuts, links follow the limbs (Le & Deng 2017)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.cages.pushing import push_out
from pliant.cages.relaxing import relaxed
from pliant.cages.rings import Ring, branch, cap, polygon_around, tube
from pliant.cages.sections import Cut, cut_loop, regions, triangle_edges
from pliant.errors import InvalidParameter, InvalidTarget, NotConverged
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.meshes.triangle_crossings import self_crossings
from pliant.numerics.ragged import Ragged

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CageBuilder:
    """A cage under construction; each step gives a new one.

    Planes cut the shape across its limbs. Around each cut lies a ring, a polygon of ``sides`` corners. Between two cuts
    the rings are linked by quadrangles, where three cuts or more meet by triangles, and a limb's end gets a cap. Which
    cuts meet follows from the mesh: it is the skeleton that the cuts imply. Then vertices are pushed out until the
    cage encloses the mesh, and made smoother and tighter while it does.

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
            No cut, one that misses the mesh or separates nothing, one inside its branch; pieces without a cut.
        """
        if not self.cuts:
            raise InvalidParameter("there is no cut yet: add one by cut(origin, normal)")
        edges = triangle_edges(self.mesh)
        loops = [cut_loop(self.mesh, edges, each, number) for number, each in enumerate(self.cuts)]
        labels, sides = regions(self.mesh, edges, loops, self.cuts)
        room = self.margin * self.mesh.diagonal
        parts = [
            polygon_around(loop.points, each, self.sides, room) for loop, each in zip(loops, self.cuts, strict=True)
        ]
        faces: list[Ring] = []
        for region in np.unique(sides):
            faces += self._region(int(region), self.mesh.points[labels == region], sides, parts)
        return PolygonMesh(np.concatenate(parts), Ragged.of(faces))

    def build(self, rounds: int = 3) -> PolygonMesh:
        """The cage.

        Parameters
        ----------
        rounds
            How often it is made smoother and tighter.

        Raises
        ------
        NotConverged
            The rings cannot be pushed out to enclose the mesh without cutting one another.
        """
        rough, clearance = self.rough(), 0.1 * self.margin * self.mesh.diagonal
        points, enclosed = push_out(rough.points, rough.triangles, self.mesh, clearance)
        crossed = len(self_crossings(points, rough.triangles))
        if not enclosed or crossed:
            what = f"its faces cut one another in {crossed} places" if enclosed else "the mesh sticks out of it"
            raise NotConverged(
                f"the {len(self.cuts)} cuts give a cage, but {what}: add cuts where the shape bends or widens, keep "
                "cuts of neighbouring limbs apart, or take a smaller margin"
            )
        return relaxed(PolygonMesh(points, rough.faces), self.mesh, rounds, clearance)

    def _region(self, region: int, inside: Points, sides: NDArray[np.int64], parts: list[Points]) -> list[Ring]:
        """The faces of one region; a cap adds a ring to ``parts``."""
        numbers, rings = [], []
        for number, (below, above) in enumerate(sides.tolist()):
            if region in (below, above):
                ring = list(range(number * self.sides, (number + 1) * self.sides))
                numbers.append(number)
                rings.append(ring if region == below else ring[::-1])
        if len(rings) == 2:
            return tube(np.concatenate(parts), *rings)
        if len(rings) > 2:
            return branch(np.concatenate(parts), rings, numbers)
        return self._cap(region, inside, numbers[0], rings[0], sides, parts)

    def _cap(
        self, region: int, inside: Points, number: int, ring: Ring, sides: NDArray[np.int64], parts: list[Points]
    ) -> list[Ring]:
        cut, room = self.cuts[number], self.margin * self.mesh.diagonal
        below = region == sides[number, 0]
        end = cap(ring, inside, cut, cut.normal if below else -cut.normal, room)
        first = sum(map(len, parts))
        parts.append(end)
        last = list(range(first, first + self.sides))
        last = last if below else last[::-1]  # as the ring is
        after = [*range(1, self.sides), 0]
        links = [[last[i], last[j], ring[j], ring[i]] for i, j in enumerate(after)]
        return [*links, last[::-1]]
