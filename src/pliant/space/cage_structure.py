"""What a mesh must be to serve as a cage: closed, oriented outwards, without a cut through itself."""

from __future__ import annotations

import weakref

from pliant.errors import InvalidDeformer
from pliant.mesh import PolygonMesh
from pliant.numerics.coordinates.winding import signed_volume
from pliant.numerics.meshes.manifold import flat_triangles, manifold_faults
from pliant.numerics.meshes.triangle_crossings import self_crossings

_sound: weakref.WeakSet[PolygonMesh] = weakref.WeakSet()


def checked_cage(mesh: PolygonMesh) -> None:
    """Refuse a mesh that cannot be a cage; a mesh that passed is not looked at again.

    Raises
    ------
    InvalidDeformer
        Saying how often, where first, and what to do.
    """
    if mesh in _sound:
        return
    if not len(mesh.faces):
        raise InvalidDeformer("the cage has no faces: it encloses nothing")
    _refuse_holes(mesh)
    flat = flat_triangles(mesh.points, mesh.triangles)
    if len(flat):
        raise InvalidDeformer(
            f"{len(flat)} triangles of the cage have no area, the first is of face {mesh.triangle_faces[flat[0]]}: "
            "merge its corners"
        )
    if signed_volume(mesh.points, mesh.triangles) < 0:
        raise InvalidDeformer("the cage is inside out: reverse the corners of its faces")
    pairs = self_crossings(mesh.points, mesh.triangles)
    if len(pairs):
        one, two = mesh.triangle_faces[pairs[0]]
        raise InvalidDeformer(
            f"the cage cuts itself: {len(pairs)} pairs of triangles do, the first are of faces {one} and {two}; "
            "move their vertices apart"
        )
    _sound.add(mesh)


def _refuse_holes(mesh: PolygonMesh) -> None:
    faults = manifold_faults(mesh.faces, len(mesh.points))
    if len(faults.open):
        a, b = faults.open[0]
        raise InvalidDeformer(
            f"the cage is open: {len(faults.open)} edges have one face only, the first is ({a}, {b}); fill its holes"
        )
    if len(faults.wrong):
        a, b = faults.wrong[0]
        raise InvalidDeformer(
            f"{len(faults.wrong)} edges of the cage have more than two faces, or two that are oriented against each "
            f"other, the first is ({a}, {b}): make it an oriented manifold"
        )
