"""A cage from a coarse mesh that somebody made by hand."""

from __future__ import annotations

from pliant.cages.pushing import push_out
from pliant.errors import InvalidParameter, InvalidTarget, NotConverged
from pliant.mesh import PolygonMesh
from pliant.numerics.coordinates.winding import signed_volume
from pliant.numerics.meshes.manifold import manifold_faults
from pliant.numerics.meshes.triangle_crossings import self_crossings


def cage_from_mesh(low_poly: PolygonMesh, mesh: PolygonMesh, margin: float = 0.005) -> PolygonMesh:
    """A coarse mesh, its vertices pushed out along their normals until it encloses a mesh.

    Its polygons stay as they are; what encloses already does not move.

    Parameters
    ----------
    low_poly
        Closed and oriented; where it is inside out, its faces are reversed.
    mesh
        What to enclose.
    margin
        How much farther than needed a vertex goes, in diagonals of the mesh.

    Raises
    ------
    InvalidTarget
        A coarse mesh that is open or not manifold, or nothing to enclose.
    NotConverged
        Pushing does not enclose the mesh, or makes the cage cut itself.
    """
    if not 0 < margin < 1:
        raise InvalidParameter(f"margin is {margin}; it must be positive, and below 1, in diagonals")
    if not len(mesh.points) or not mesh.diagonal > 0:
        raise InvalidTarget("there is nothing to enclose: the mesh has no extent")
    faults = manifold_faults(low_poly.faces, len(low_poly.points))
    if not len(low_poly.faces) or not faults.none:
        raise InvalidTarget(
            f"the coarse mesh has {len(faults.open)} open edges, {len(faults.wrong)} edges of more than two faces or "
            f"of two that disagree, and {len(faults.pinched)} pinched vertices: a cage is closed and manifold"
        )
    cage = low_poly
    if signed_volume(cage.points, cage.triangles) < 0:
        cage = PolygonMesh(cage.points, [face[::-1] for face in cage.faces])  # type: ignore[arg-type]
    points, enclosed = push_out(cage.points, cage.triangles, mesh, margin * mesh.diagonal)
    crossed = len(self_crossings(points, cage.triangles))
    if not enclosed or crossed:
        what = f"it cuts itself in {crossed} places" if enclosed else "the mesh still sticks out"
        raise NotConverged(f"the coarse mesh was pushed out, but {what}: make it wider where the mesh leaves it")
    return cage.with_points(points)
