"""Cages for the studio: planes from lines that are drawn across a limb, cages built in the background, and reports."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pliant.cages.boxes import cage_from_box
from pliant.cages.builder import CageBuilder
from pliant.cages.building import build_cage
from pliant.cages.checking import CageReport
from pliant.cages.constructing import Construction
from pliant.cages.rings import polygon_around
from pliant.cages.sections import Cut, cut_loop, triangle_edges
from pliant.errors import InvalidParameter, PliantError
from pliant.mesh import Points, PolygonMesh

Floats = NDArray[np.float64]
Method = Literal["offset", "alpha_wrap", "box", "cuts"]
METHODS: tuple[Method, ...] = ("offset", "alpha_wrap", "box", "cuts")


@dataclass(frozen=True, eq=False)
class Plan:
    """How a cage shall be built.

    Parameters
    ----------
    method
        ``"offset"`` or ``"alpha_wrap"``: automatically; ``"box"``; ``"cuts"``: by planes.
    vertices
        The budget; of a box, about as many.
    margin
        Room around the shape, in its diagonals.
    symmetry
        An axis, or None.
    cuts
        (k, 6) origins and normals of planes.
    sides
        Corners of a ring.
    """

    method: Method
    vertices: int
    margin: float
    symmetry: Literal["x", "y", "z"] | None
    cuts: Floats
    sides: int

    def build(self, mesh: PolygonMesh, progress: Callable[[float], None]) -> Construction:
        """The cage around a mesh, and the planes that have no ring in it."""
        if self.method == "cuts":
            return self.builder(mesh).construct(vertices=self.vertices, progress=progress)
        if self.method == "box":
            return Construction(cage_from_box(mesh, _cells(mesh, self.vertices), self.margin), ())
        found = build_cage(
            mesh, self.vertices, self.margin, method=self.method, symmetry=self.symmetry, progress=progress
        )
        return Construction(found, ())

    def builder(self, mesh: PolygonMesh) -> CageBuilder:
        """The planes so far, as a cage under construction."""
        builder = CageBuilder(mesh, self.sides, self.margin)
        for cut in self.cuts:
            builder = builder.cut(cut[:3], cut[3:])
        return builder


@dataclass(frozen=True, eq=False)
class Sketch:
    """What planes give, before it is a cage.

    Parameters
    ----------
    points, links
        (k, 3) corners of rings, and (e, 2) which are joined: the rings alone, where they cannot be linked yet.
    linked
        Whether all of them make a closed surface.
    message
        Why not.
    """

    points: Points
    links: NDArray[np.uint32]
    linked: bool
    message: str = ""


def sketch(builder: CageBuilder) -> Sketch:
    """The rings of a cage under construction, linked where they can be."""
    if not builder.cuts:
        return Sketch(np.empty((0, 3)), np.empty((0, 2), np.uint32), linked=False)
    try:
        rough = builder.rough()
        return Sketch(rough.points, rough.edges[:, :2].astype(np.uint32), linked=True)
    except PliantError as error:
        rings = [_ring(builder, cut, number) for number, cut in enumerate(builder.cuts)]
        sides = builder.sides
        around = np.stack([np.arange(sides), np.roll(np.arange(sides), -1)], axis=1)
        links = np.concatenate([around + sides * at for at in range(len(rings))]).astype(np.uint32)
        return Sketch(np.concatenate(rings), links, linked=False, message=str(error))


def plane_across(mesh: PolygonMesh, inside: Floats, first: Floats, second: Floats) -> Cut:
    """The plane through a line that was drawn on the screen, along the view.

    Parameters
    ----------
    mesh
        What is cut.
    inside
        (3,) a place in the limb that the line crosses.
    first, second
        (6,) rays through the ends of the line: a point and a direction.

    Raises
    ------
    InvalidParameter
        The line has no length, or misses the shape.
    """
    ends = [ray[:3] + ((inside - ray[:3]) @ ray[3:]) / (ray[3:] @ ray[3:]) * ray[3:] for ray in (first, second)]
    normal = np.cross(ends[1] - ends[0], first[3:] + second[3:])
    length = float(np.linalg.norm(normal))
    if not length > 1e-9 * mesh.diagonal:
        raise InvalidParameter("the line is too short: draw it across a limb")
    start = Cut(inside - ((inside - ends[0]) @ normal) / length**2 * normal, normal / length)
    loop = cut_loop(mesh, triangle_edges(mesh), start, 0)
    return Cut((loop.points.min(axis=0) + loop.points.max(axis=0)) / 2, start.normal)


def told(report: CageReport) -> dict[str, Any]:
    """A report as pages are told it."""
    return {
        "ok": report.ok,
        "failures": list(report.failures),
        "vertices": report.vertices,
        "faces": report.faces,
        "genus": report.genus,
        "volume_ratio": report.volume_ratio,
        "clearance": report.clearance,
        "manifold": report.manifold,
        "simple": report.crossed == 0,
        "encloses": report.outside == 0 and report.through == 0,
    }


def _ring(builder: CageBuilder, cut: Cut, number: int) -> Points:
    loop = cut_loop(builder.mesh, triangle_edges(builder.mesh), cut, number)
    return polygon_around(loop.points, cut, builder.sides, builder.margin * builder.mesh.diagonal)


def _cells(mesh: PolygonMesh, vertices: int) -> tuple[int, int, int]:
    """Cells of a box, as cubic as can be, with about so many vertices on it."""
    extent = np.maximum(np.ptp(mesh.points, axis=0), 0.05 * mesh.diagonal)
    best = (1, 1, 1)
    for fine in np.linspace(0.5, 30, 120):
        x, y, z = np.maximum(np.rint(fine * extent / extent.max()), 1).astype(int).tolist()
        if (x + 1) * (y + 1) * (z + 1) - (x - 1) * (y - 1) * (z - 1) <= vertices:
            best = (x, y, z)
    return best
