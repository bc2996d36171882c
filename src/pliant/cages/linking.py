"""Rings linked region by region: tubes, branches and caps."""

from __future__ import annotations

import numpy as np

from pliant.cages.parting import Parts
from pliant.cages.rings import Ring, branch, cap, polygon_around, tube
from pliant.cages.sections import Cut
from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.numerics.ragged import Ragged


def linked(parts: Parts, cuts: tuple[Cut, ...], sides: int, room: float) -> PolygonMesh:
    """Rings around cuts, and the fewest faces between them: they need not enclose anything yet.

    Parameters
    ----------
    parts, cuts
        The regions, and the planes between them.
    sides, room
        Corners of each ring, and its distance from the section.

    Raises
    ------
    InvalidParameter
        Limbs that meet where one ring is inside the hull of the others.
    """
    points = [polygon_around(parts.points[rim], cut, sides, room) for rim, cut in zip(parts.rims, cuts, strict=True)]
    faces: list[Ring] = []
    for region in np.unique(parts.sides).tolist():
        numbers = np.flatnonzero((parts.sides == region).any(axis=1)).tolist()
        rings = []
        for number in numbers:
            ring = list(range(number * sides, (number + 1) * sides))
            rings.append(ring if parts.sides[number, 0] == region else ring[::-1])
        if len(rings) == 1:
            cut, below = cuts[numbers[0]], region == parts.sides[numbers[0], 0]
            points.append(cap(rings[0], parts.inside(region), cut, cut.normal if below else -cut.normal, room))
            faces += _capped(rings[0], sides * (len(points) - 1), below)
            continue
        every = np.concatenate(points)
        found = tube(every, *rings) if len(rings) == 2 else branch(every, rings)
        if found is None:
            raise InvalidParameter(
                f"the region between cuts {', '.join(map(str, numbers))} cannot be sketched: add a cut where it "
                "branches; the cage can be built all the same"
            )
        faces += found
    return PolygonMesh(np.concatenate(points), Ragged.of(faces))


def _capped(ring: Ring, first: int, below: bool) -> list[Ring]:
    """The faces between a ring and the last one of its limb, and that one."""
    last = list(range(first, first + len(ring)))
    last = last if below else last[::-1]  # as the ring is
    after = [*range(1, len(ring)), 0]
    return [*([last[i], last[j], ring[j], ring[i]] for i, j in enumerate(after)), last[::-1]]
