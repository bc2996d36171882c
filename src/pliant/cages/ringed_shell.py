"""A shell with the user's planes on it: where each passes through its limb, a loop of edges, to become a ring."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.cages.rings import polygon_around, reach_of
from pliant.cages.sections import Cut, Loop, cut_loop, edges_of, section, triangle_edges
from pliant.cages.shell import Shell, shell_around
from pliant.cages.splitting import Split, loops_apart, split
from pliant.errors import InvalidParameter
from pliant.mesh import Points, PolygonMesh

Indices = NDArray[np.int64]

_NEAR = 0.15  # cells: vertices of a shell that are nearer to a plane than this are moved away from it
TOUCHES = "another part of the shape is too near to its limb there"
_JOINED = 1.0  # offsets: a section of the shell that goes farther than expected by this holds another limb too
_WIDER, _BESIDE = 1.5, 3.0  # how much farther it may go where there is no other way: of its own reach, and in offsets


@dataclass(frozen=True)
class LeftOut:
    """A plane without a ring: its number, and why."""

    number: int
    reason: str


@dataclass(frozen=True)
class Ring:
    """Where a plane is on a shell.

    Parameters
    ----------
    cut
        The plane.
    rim
        Vertices of the shell, in order, counter-clockwise about the plane's normal.
    corners
        (sides, 3) the polygon around the section, where the ring shall be.
    """

    cut: Cut
    rim: Indices
    corners: Points


@dataclass(frozen=True)
class RingedShell:
    """The surface with its rings, the shell it was made of, and the planes without a ring."""

    surface: Split
    shell: Shell
    rings: tuple[Ring, ...]
    left_out: tuple[LeftOut, ...]


def ringed_shell(
    mesh: PolygonMesh, cuts: tuple[Cut, ...], sides: int, room: float, coarser: float = 1.0
) -> RingedShell:
    """The shell around a mesh, with the rings of all planes that can have one.

    Raises
    ------
    InvalidParameter
        No plane meets the mesh.
    """
    mesh = welded(mesh)
    edges = triangle_edges(mesh)
    loops: dict[int, Loop] = {}
    left_out = []
    for number, cut in enumerate(cuts):
        try:
            loops[number] = cut_loop(mesh, edges, cut, number)
        except InvalidParameter:
            left_out.append(LeftOut(number, "it misses the shape"))
    if not loops:
        raise InvalidParameter("no cut meets the mesh: move their origins into the limbs that they shall cut")
    limbs = nearest_loops(mesh.points, edges, [(cuts[number], loop.edges) for number, loop in loops.items()])
    shell = shell_around(mesh, limbs, 0.75 * room, coarser)
    found, rings, waiting = Split(shell.points, shell.triangles), [], list(loops)
    shell_edges = edges_of(found.triangles)
    reasons: dict[int, str] = {}
    for loosely in (False, True):  # planes whose limb touches another one get what is left
        for number in waiting.copy():
            after, around, reasons[number] = _with_ring(found, shell_edges, cuts[number], loops[number], shell, loosely)
            if after is not None:
                found, shell_edges = after, edges_of(after.triangles)
                waiting.remove(number)
                wide = max(room, shell.offset) if around is loops[number].points else 0.25 * shell.offset
                rings.append(Ring(cuts[number], found.rims[-1], polygon_around(around, cuts[number], sides, wide)))
    left_out += [LeftOut(number, reasons[number]) for number in waiting]
    left_out.sort(key=lambda each: each.number)
    return RingedShell(found, shell, tuple(rings), tuple(left_out))


def _with_ring(
    found: Split, edges: Indices, given: Cut, loop: Loop, shell: Shell, loosely: bool
) -> tuple[Split | None, Points, str]:
    """The shell split along one more plane, or None; what its ring goes around; and why there is none."""
    cut = Cut((loop.points.min(axis=0) + loop.points.max(axis=0)) / 2, given.normal)
    points = _off_the_plane(found, cut, _NEAR * shell.spacing)
    try:
        around = section(points, found.triangles, edges, cut, 0)
    except InvalidParameter:
        return None, loop.points, "it misses the shape"
    reach = reach_of(loop.points, cut)
    farther = float((reach_of(around.points, cut) - reach).max()) - shell.offset
    most = max(_WIDER * reach.max(), _BESIDE * shell.offset) if loosely else _JOINED * shell.offset
    if farther > most:
        return None, loop.points, TOUCHES
    if not loops_apart(found, edges, around):
        return None, loop.points, "it crosses another plane on the shape"
    after = split(Split(points, found.triangles, found.rims), edges, around, cut)
    return after, around.points if farther > _JOINED * shell.offset else loop.points, "the shape touches itself there"


def _off_the_plane(found: Split, cut: Cut, least: float) -> Points:
    """Vertices moved away from a plane, so that no sliver comes of its section; those on rims stay."""
    height = (found.points - cut.origin) @ cut.normal
    near = np.abs(height) < least
    if found.rims:
        near[np.concatenate(found.rims)] = False
    points = found.points.copy()
    points[near] += np.where(height[near] < 0, -least - height[near], least - height[near])[:, None] * cut.normal
    return points


def welded(mesh: PolygonMesh) -> PolygonMesh:
    """The triangles of a mesh; where it is open, corners at the same place are one."""
    if not mesh.edge_use[0]:
        return mesh
    points, place = np.unique(mesh.points, axis=0, return_inverse=True)
    triangles = place.reshape(-1)[mesh.triangles]
    whole = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    return PolygonMesh(points, triangles[whole])


def nearest_loops(points: Points, edges: Indices, loops: list[tuple[Cut, Indices]]) -> Indices:
    """(n,) the side of a loop that is nearest along the surface: what parts limbs; -1 where none is reached."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import dijkstra

    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    lengths = np.maximum(lengths, 1e-12 * lengths.max())  # a zero would be no edge at all
    graph = coo_array((lengths, edges.T), shape=(len(points), len(points))).tocsr()
    owner = np.full(len(points), -1)
    for number, (cut, loop) in enumerate(loops):
        ends = edges[loop].reshape(-1)
        owner[ends] = 2 * number + ((points[ends] - cut.origin) @ cut.normal >= 0)
    _, _, source = dijkstra(
        graph, directed=False, indices=np.flatnonzero(owner >= 0), min_only=True, return_predecessors=True
    )
    return np.where(source >= 0, owner[np.maximum(source, 0)], -1)
