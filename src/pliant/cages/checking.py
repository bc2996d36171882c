"""What a cage must be, verified one by one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.cages.extras import import_manifold
from pliant.mesh import PolygonMesh
from pliant.numerics.coordinates.winding import signed_volume, winding_numbers
from pliant.numerics.meshes.closest_surface import TriangleSearch
from pliant.numerics.meshes.manifold import Faults, flat_triangles, manifold_faults, pieces
from pliant.numerics.meshes.triangle_crossings import crossings, self_crossings


@dataclass(frozen=True)
class CageReport:
    """What :func:`check_cage` found.

    Parameters
    ----------
    failures
        What is wrong, with counts and the first place; empty where nothing is.
    vertices, faces
        How many the cage has.
    components, genus
        Pieces that do not touch; handles of all pieces together, None where the cage is no closed manifold.
    volume_ratio
        The cage's volume over the mesh's, which says how tight it is; None where the mesh is open.
    clearance
        The least distance of a vertex of the mesh from the cage, in diagonals of the mesh; negative outside.
    manifold
        Whether it is closed, and around every vertex and edge a surface.
    crossed
        Pairs of its triangles that cut one another.
    outside, through
        Vertices of the mesh that are outside, and triangles of the mesh that cut through it.
    """

    failures: tuple[str, ...]
    vertices: int
    faces: int
    components: int
    genus: int | None
    volume_ratio: float | None
    clearance: float
    manifold: bool
    crossed: int
    outside: int
    through: int

    @property
    def ok(self) -> bool:
        """Whether nothing failed."""
        return not self.failures


def check_cage(cage: PolygonMesh, mesh: PolygonMesh, *, vertices: int | None = None) -> CageReport:
    """Verify that a cage is a closed, oriented manifold that does not cut itself and encloses a mesh.

    Where manifold3d is installed it confirms that the cage is a solid.

    Parameters
    ----------
    cage
        The cage; polygons are judged by their triangles.
    mesh
        What it shall enclose: every vertex, and every face.
    vertices
        How many vertices the cage may have; None = any number.

    Returns
    -------
    CageReport
        With all that fails, by name.
    """
    faults = manifold_faults(cage.faces, len(cage.points))
    failures = _structure(cage, faults)
    flat = flat_triangles(cage.points, cage.triangles)
    if len(flat):
        failures.append(f"{len(flat)} triangles have no area, the first is {flat[0]}")
    crossed = self_crossings(cage.points, cage.triangles)
    if len(crossed):
        failures.append(
            f"it cuts itself: {len(crossed)} pairs of triangles, the first are {crossed[0][0]} and {crossed[0][1]}"
        )
    if vertices is not None and len(cage.points) > vertices:
        failures.append(f"it has {len(cage.points)} vertices, {vertices} are allowed")
    outward = signed_volume(cage.points, cage.triangles) > 0
    if len(cage.faces) and not outward:
        failures.append("it is inside out: its volume is not positive")
    if faults.none and outward and not len(crossed) and not _solid(cage):
        failures.append("manifold3d does not take it for a solid")
    outside = np.flatnonzero(winding_numbers(mesh.points, cage.points, cage.triangles) < 0.5)
    if len(outside):
        failures.append(f"{len(outside)} of {len(mesh.points):,} vertices are outside, the first is {outside[0]}")
    pairs = crossings(cage.points, cage.triangles, mesh.points, mesh.triangles)
    if len(pairs):
        through = np.unique(pairs[:, 1])
        failures.append(f"{len(through)} triangles of the mesh cut through it, the first is {through[0]}")
    components, _ = pieces(cage.edges[:, :2].astype(np.int64), len(cage.points))
    return CageReport(
        tuple(failures),
        len(cage.points),
        len(cage.faces),
        components,
        _genus(cage, components) if faults.none else None,
        _tightness(cage, mesh),
        _clearance(cage, mesh, outside, np.delete(cage.triangles, flat, axis=0)),
        bool(faults.none) and len(cage.faces) > 0,
        len(crossed),
        len(outside),
        len(np.unique(pairs[:, 1])),
    )


def _structure(cage: PolygonMesh, faults: Faults) -> list[str]:
    failures = []
    if not len(cage.faces):
        failures.append("it has no faces")
    if len(faults.open):
        failures.append(f"it is open: {len(faults.open)} edges have one face, the first is {_pair(faults.open)}")
    if len(faults.wrong):
        failures.append(
            f"{len(faults.wrong)} edges have more than two faces, or two oriented against each other, the first is "
            f"{_pair(faults.wrong)}"
        )
    if len(faults.pinched):
        failures.append(f"{len(faults.pinched)} vertices join fans that only touch, the first is {faults.pinched[0]}")
    loose = np.setdiff1d(np.arange(len(cage.points)), cage.faces.flat)
    if len(loose):
        failures.append(f"{len(loose)} vertices belong to no face, the first is {loose[0]}")
    return failures


def _pair(edges: np.ndarray) -> str:
    return f"({edges[0, 0]}, {edges[0, 1]})"


def _solid(cage: PolygonMesh) -> bool:
    """Whether manifold3d, if it is there, takes the triangles for a solid."""
    library = import_manifold()
    if library is None:
        return True
    mesh = library.Mesh64(np.array(cage.points), np.array(cage.triangles, np.uint64))  # it takes no read-only ones
    return bool(library.Manifold(mesh).status() == library.Error.NoError)


def _genus(cage: PolygonMesh, components: int) -> int:
    euler = len(cage.points) - len(cage.edges) + len(cage.faces)
    return (2 * components - euler) // 2


def _tightness(cage: PolygonMesh, mesh: PolygonMesh) -> float | None:
    volume = signed_volume(mesh.points, mesh.triangles)
    if mesh.edge_use[0] or not abs(volume) > 0:
        return None
    return float(signed_volume(cage.points, cage.triangles) / abs(volume))


def _clearance(cage: PolygonMesh, mesh: PolygonMesh, outside: np.ndarray, triangles: np.ndarray) -> float:
    if not len(triangles) or not len(mesh.points) or not mesh.diagonal > 0:
        return 0.0
    found = TriangleSearch(cage.points, triangles).query(mesh.points)
    distance = np.linalg.norm(mesh.points - found.points, axis=1)
    distance[outside] *= -1
    return float(distance.min() / mesh.diagonal)
