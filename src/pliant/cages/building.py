"""Building a cage around any mesh: offset, simplify, push out, check."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pliant.cages.checking import check_cage
from pliant.cages.decimating import decimated
from pliant.cages.offset import offset_surface
from pliant.cages.pushing import push_out
from pliant.cages.symmetry import checked_axis, symmetrized, with_mirror_image
from pliant.cages.wrapping import alpha_wrapped
from pliant.errors import InvalidParameter, InvalidTarget, NotConverged
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.meshes.triangle_crossings import self_crossings
from pliant.numerics.ragged import Ragged

Triangles = NDArray[np.int64]

_OFFSETS = (0.02, 0.03, 0.045, 0.07, 0.1)  # of the diagonal, tried in turn
_LEAST = 8  # vertices: a box
_SHARES = (0.9, 0.75, 0.6, 0.45)  # of the vertices, for a cage whose half is doubled
_DENSE = 24  # faces for each wanted vertex, before intersections are looked after


def build_cage(
    mesh: PolygonMesh,
    vertices: int = 150,
    margin: float = 0.02,
    *,
    method: Literal["offset", "alpha_wrap"] = "offset",
    symmetry: Literal["x", "y", "z"] | None = None,
    progress: Callable[[float], object] = lambda _: None,
) -> PolygonMesh:
    """A closed, oriented manifold of triangles that encloses a mesh and does not cut itself.

    The surface at some distance around the mesh is simplified by quadric errors (Garland & Heckbert 1997), with edges
    that must not collapse into other faces, and pushed out until it encloses every vertex and every face. Where that
    fails, or :func:`check_cage` finds a fault, the distance is widened. The mesh may be open, in pieces or not
    manifold.

    Parameters
    ----------
    mesh
        What to enclose.
    vertices
        How many vertices the cage may have.
    margin
        The distance that is tried first, in diagonals of the mesh.
    method
        ``"offset"``, or ``"alpha_wrap"``: CGAL's alpha wrapping (Portaneri et al. 2022), tighter, through pymeshlab,
        which is under the GPL and comes with the extra ``cages-gpl``.
    symmetry
        Make the cage exactly symmetric about the middle of the mesh's box across this axis; it encloses the mesh and
        its mirror image.
    progress
        Told how far it is, from 0 to 1, of each distance that is tried; what it raises ends the work.

    Raises
    ------
    InvalidParameter, InvalidTarget
        A budget below 8, a margin that is not positive; a mesh without faces.
    NotConverged
        No distance gave a cage that encloses the mesh: the last report is quoted.
    MissingExtra
        The packages of the extra are not installed.
    """
    if vertices < _LEAST:
        raise InvalidParameter(f"a cage of {vertices} vertices was asked for; {_LEAST} is the least that is built")
    if not 0 < margin <= 1:
        raise InvalidParameter(f"margin is {margin}; it must be positive, and at most 1, in diagonals")
    if method not in ("offset", "alpha_wrap"):
        raise InvalidParameter(f"method is {method!r}; it must be 'offset' or 'alpha_wrap'")
    if not len(mesh.triangles) or not mesh.diagonal > 0:
        raise InvalidTarget("a cage is built around faces, and this mesh has none")
    if symmetry is not None:
        return _symmetric(mesh, vertices, margin, method, symmetry, progress)
    if method == "alpha_wrap":
        return alpha_wrapped(mesh, vertices, margin)
    reason = ""
    for part in (margin, *(each for each in _OFFSETS if each > margin)):
        progress(0.0)
        surface = offset_surface(mesh, part * mesh.diagonal)
        progress(0.3)
        points, triangles = _simplified(*surface, vertices)
        progress(0.7)
        points, enclosed = push_out(points, triangles, mesh, 0.05 * part * mesh.diagonal)
        cage = PolygonMesh(points, Ragged.of(triangles))
        progress(0.85)
        report = check_cage(cage, mesh, vertices=vertices)
        if enclosed and report.ok:
            return cage
        reason = "; ".join(report.failures)
    raise NotConverged(
        f"no cage of {vertices} vertices was found: {reason}. Allow more vertices, or a wider margin than {margin}"
    )


def _symmetric(
    mesh: PolygonMesh,
    vertices: int,
    margin: float,
    method: Literal["offset", "alpha_wrap"],
    axis: str,
    progress: Callable[[float], object],
) -> PolygonMesh:
    """Half of a cage around the mesh and its mirror image, twice; with fewer vertices while there are too many."""
    both, place = with_mirror_image(mesh, axis), float(mesh.center[checked_axis(axis)])
    reason = ""
    for share in _SHARES:
        whole = build_cage(both, max(int(share * vertices), _LEAST), margin, method=method, progress=progress)
        cage = symmetrized(whole, axis, place)
        report = check_cage(cage, mesh, vertices=vertices)
        if report.ok:
            return cage
        reason = "; ".join(report.failures)
    raise NotConverged(f"no symmetric cage of {vertices} vertices was found: {reason}. Allow more vertices")


def _simplified(points: Points, triangles: Triangles, vertices: int) -> tuple[Points, Triangles]:
    """At most ``vertices`` vertices: coarsely first, then without letting faces cut one another."""
    coarse, faces = decimated(points, triangles, _DENSE * vertices, careful=False)
    if len(self_crossings(coarse, faces)):
        coarse, faces = points, triangles
    euler = len(coarse) - len(faces) // 2
    return decimated(coarse, faces, 2 * (vertices - euler), careful=True)
