"""Building a cage by hand: planes cut the shape, rings go around the cuts, links follow the limbs (Le & Deng 2017)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from pliant.cages.constructing import Construction, constructed
from pliant.cages.linking import linked
from pliant.cages.parting import Parts, parted
from pliant.cages.sections import Cut
from pliant.errors import InvalidParameter, InvalidTarget
from pliant.mesh import PolygonMesh


@dataclass(frozen=True, eq=False)
class CageBuilder:
    """A cage under construction; each step gives a new one.

    Planes cut the shape across its limbs. Around each cut lies a ring, a polygon of ``sides`` corners, in its plane.
    The surface at some distance around the shape is split along the planes and made coarser: rings until they have
    their corners, what is between them until it has as few vertices as the shape lets it. Only steps are taken after
    which it still encloses the mesh and does not cut itself, so that there is a cage for any planes, and the mesh may
    be open, in pieces, or cut itself. A plane has no ring where another part of the shape is too near, or where it
    crosses another plane on the shape: :meth:`construct` tells which.

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
        return linked(self._parted(), self.cuts, self.sides, self.margin * self.mesh.diagonal)

    def build(
        self, rounds: int = 3, *, vertices: int | None = None, progress: Callable[[float], object] = lambda _: None
    ) -> PolygonMesh:
        """The cage; :meth:`construct` tells also which planes have no ring in it.

        Parameters
        ----------
        rounds
            How often it is made smoother and tighter.
        vertices
            How many vertices it may have, if its rings need no more; None = as many as the shape needs.
        progress
            Told how far it is, from 0 to 1; what it raises ends the work.

        Raises
        ------
        InvalidParameter
            No cut, or none that meets the mesh.
        """
        return self.construct(rounds, vertices=vertices, progress=progress).cage

    def construct(
        self, rounds: int = 3, *, vertices: int | None = None, progress: Callable[[float], object] = lambda _: None
    ) -> Construction:
        """The cage, and which planes have no ring in it, and why; with the parameters of :meth:`build`."""
        if not self.cuts:
            raise InvalidParameter("there is no cut yet: add one by cut(origin, normal)")
        return constructed(self.mesh, self.cuts, self.sides, self.margin, rounds, vertices, progress)

    def _parted(self) -> Parts:
        if not self.cuts:
            raise InvalidParameter("there is no cut yet: add one by cut(origin, normal)")
        return parted(self.mesh, self.cuts)
