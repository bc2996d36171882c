"""A cage whose rings lie on planes: a shell around the mesh, made coarser while it stays sound.

At each moment the surface is closed, a manifold, does not cut itself and encloses the mesh: the shell does, and only
such changes are made that keep it so. Nothing has to be tried again; at worst a cage has more vertices than wanted, or
a plane no ring.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pliant.cages.building import build_cage
from pliant.cages.checking import check_cage
from pliant.cages.quads import with_quads
from pliant.cages.ringed_shell import TOUCHES, LeftOut, RingedShell, ringed_shell
from pliant.cages.sections import Cut
from pliant.cages.splitting import beside, regions_between
from pliant.cages.thinning import Thinning
from pliant.mesh import PolygonMesh
from pliant.numerics.ragged import Ragged

_SHARES = (1.0, 0.45)  # of the margin: nearer to the mesh, where limbs touch
_COARSER = (1.0, 1.5, 2.5)  # cells, should the first ones not do
_ROOMS = (0.3, 0.1, 0.01)  # of the shell's distance: what stays between mesh and cage
_LIMIT = 2e-5  # of the fourth power of the diagonal: the error up to which a cage is made coarser
_MOST = 4  # times as many vertices as rings, ends and branches ask for
_REACH = 0.5  # of the same: the unit in which vertices go outwards
_LEAST = 24
_ROUNDS = 2  # of smoothing in each round that is asked for


@dataclass(frozen=True, eq=False)
class Construction:
    """A cage by planes.

    Parameters
    ----------
    cage
        It encloses the mesh and does not cut itself.
    left_out
        The planes without a ring, and why.
    """

    cage: PolygonMesh
    left_out: tuple[LeftOut, ...]


def constructed(
    mesh: PolygonMesh,
    cuts: tuple[Cut, ...],
    sides: int,
    margin: float,
    rounds: int,
    vertices: int | None,
    progress: Callable[[float], object],
) -> Construction:
    """A cage around a mesh, with a ring on each plane where that can be.

    Raises
    ------
    InvalidParameter
        No plane meets the mesh.
    """
    progress(0.0)
    room = margin * mesh.diagonal
    for coarser in _COARSER:
        ringed = _ringed(mesh, cuts, sides, room, coarser)
        progress(0.3)
        cage = _coarse(mesh, ringed, sides, rounds, vertices, progress)
        progress(0.9)
        if check_cage(cage, mesh).ok:
            return Construction(cage, ringed.left_out)
    cage = build_cage(mesh, max(vertices or sides * (len(cuts) + 2), 60), margin)
    return Construction(cage, tuple(LeftOut(number, "no ring could be kept") for number in range(len(cuts))))


def _ringed(mesh: PolygonMesh, cuts: tuple[Cut, ...], sides: int, room: float, coarser: float) -> RingedShell:
    """The shell with most rings, of one as far away as wanted, and where limbs touch of one that is nearer."""
    best: RingedShell | None = None
    for share in _SHARES:
        found = ringed_shell(mesh, cuts, sides, share * room, coarser)
        if best is None or len(found.left_out) < len(best.left_out):
            best = found
        if all(each.reason != TOUCHES for each in best.left_out):
            break
    assert best is not None
    return best


def _coarse(
    mesh: PolygonMesh,
    ringed: RingedShell,
    sides: int,
    rounds: int,
    vertices: int | None,
    progress: Callable[[float], object],
) -> PolygonMesh:
    offset, rings = ringed.shell.offset, [(ring.rim, ring.cut.normal, ring.corners) for ring in ringed.rings]
    thinning = Thinning(mesh, ringed.surface.points, ringed.surface.triangles, rings)
    least = _natural(ringed, sides)
    most = vertices or _MOST * least
    for room in _ROOMS:
        if thinning.vertices > least:
            thinning.collapse(min(least, most), room * offset, _REACH * offset, _LIMIT * mesh.diagonal**4)
        progress(0.6)
        thinning.collapse(most, room * offset, _REACH * offset)
        thinning.flip(room * offset)
        thinning.smooth(0.5, room * offset)
        if thinning.vertices <= most and thinning.rings_done:
            break
    for _ in range(_ROUNDS * rounds):
        thinning.flip(_ROOMS[0] * offset)
        thinning.smooth(0.5, _ROOMS[0] * offset)
    points, triangles, found = thinning.surface()
    return PolygonMesh(points, Ragged.of(with_quads(points, triangles, found)))


def _natural(ringed: RingedShell, sides: int) -> int:
    """How many vertices the rings have, with another ring for each end and for each limb more than two that meet."""
    surface = ringed.surface
    region = regions_between(surface)
    degree = np.zeros(int(region.max()) + 1, int)
    for rim in surface.rims:
        np.add.at(degree, list(beside(surface, region, rim)), 1)
    more = np.count_nonzero(degree == 1) + np.maximum(degree - 2, 0).sum()
    return max(sides * (len(surface.rims) + int(more)), _LEAST)
