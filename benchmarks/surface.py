"""Surface deformers against their peers: `python benchmarks/surface.py`."""

from __future__ import annotations

import time

import igl
import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import eigsh

from measure import Comparison, report
from pliant.mesh import PolygonMesh
from pliant.numerics.meshes.eigenpairs import lowest_eigenpairs
from pliant.numerics.meshes.laplacians import cotangent_weights, laplacian, masses
from pliant.surface.arap import ARAP
from pliant.surface.laplacian_edit import LaplacianEdit
from pliant.surface.transfer import DeformationTransfer

NOTES: list[str] = []


def torus(along: int, around: int) -> PolygonMesh:
    """A torus of along × around vertices, with bumps."""
    u, v = np.meshgrid(
        np.linspace(0, 2 * np.pi, along, endpoint=False),
        np.linspace(0, 2 * np.pi, around, endpoint=False),
        indexing="ij",
    )
    r = 1 + 0.1 * np.cos(7 * u) * np.sin(5 * v)
    points = np.stack([(3 + r * np.cos(v)) * np.cos(u), (3 + r * np.cos(v)) * np.sin(u), r * np.sin(v)], axis=-1)
    i, j = np.meshgrid(np.arange(along), np.arange(around), indexing="ij")

    def at(a, b):
        return ((a % along) * around + b % around).ravel()

    one = np.column_stack([at(i, j), at(i + 1, j), at(i + 1, j + 1)])
    two = np.column_stack([at(i, j), at(i + 1, j + 1), at(i, j + 1)])
    return PolygonMesh(points.reshape(-1, 3), np.vstack([one, two]))


def parts(mesh: PolygonMesh):
    """The region, all but an anchored patch; the handle, a patch opposite; and a goal for it."""
    x = mesh.points[:, 0]
    roi, handle = np.flatnonzero(x > x.min() + 0.3), np.flatnonzero(x > x.max() - 0.3)
    return roi, handle, mesh.points[handle] + [0.5, 0.3, 1.0]


def laplacian_comparisons(along: int, around: int) -> list[Comparison]:
    mesh = torus(along, around)
    roi, handle, goal = parts(mesh)
    count = f"{len(mesh.points) // 1000}k"
    fixed = np.setdiff1d(np.arange(len(mesh.points)), roi)
    known = np.concatenate([handle, fixed]).astype(np.int64)
    values = np.vstack([goal, mesh.points[fixed]]) - mesh.points[known]
    stiffness = laplacian(cotangent_weights(mesh.points, mesh.triangles))
    matrix = sp.csc_matrix(stiffness @ sp.diags_array(1 / masses(mesh.points, mesh.triangles)) @ stiffness)
    nothing, empty = sp.csc_matrix((0, len(mesh.points))), np.zeros((0, 3))
    zero = np.zeros((len(mesh.points), 3))

    def prepare():
        data = igl.min_quad_with_fixed_data()
        igl.min_quad_with_fixed_precompute(matrix, known, nothing, True, data)
        return data

    edit = LaplacianEdit(roi, handle)
    bound, data, out = edit.bind(mesh), prepare(), np.empty_like(mesh.points)

    def peer():
        return mesh.points + igl.min_quad_with_fixed_solve(data, zero, values, empty)

    error = np.abs(peer() - bound.deform(goal)).max()
    NOTES.append(f"Laplacian edit, {count}: libigl and pliant differ by {error:.1e} of a mesh of size 8.")
    return [
        Comparison(
            f"Laplacian edit, {count}, whole mesh: one handle move",
            {"pliant": lambda: bound.deform(goal, out=out), "libigl min_quad_with_fixed": peer},
        ),
        Comparison(
            f"the same, {count}: set-up (libigl's is given its matrix)",
            {"pliant": lambda: edit.bind(mesh), "libigl": prepare},
            rounds=1,
        ),
    ]


def energy_of(bound, points) -> float:
    return bound.cells.turn(np.ascontiguousarray(points), bound.cells.identities())


def arap_comparisons(along: int, around: int) -> list[Comparison]:
    mesh = torus(along, around)
    roi, handle, goal = parts(mesh)
    count = f"{len(mesh.points) // 1000}k"
    fixed = np.setdiff1d(np.arange(len(mesh.points)), roi)
    known = np.concatenate([handle, fixed]).astype(np.int32)
    values = np.ascontiguousarray(np.vstack([goal, mesh.points[fixed]]))
    faces = mesh.triangles.astype(np.int64)

    def prepare():
        data = igl.ARAPData()
        data.max_iter = 1
        data.energy = igl.ARAPEnergyType.ARAP_ENERGY_TYPE_SPOKES
        igl.arap_precomputation(mesh.points, faces, 3, known, data)
        return data

    bound, data = ARAP(roi, handle, tolerance=1e-3, iterations=500).bind(mesh), prepare()
    points, energies = igl.arap_solve(values, data, mesh.points.copy()), []
    for _ in range(500):
        energies.append(energy_of(bound, points))
        if len(energies) > 1 and energies[-2] - energies[-1] <= 1e-3 * energies[-2]:
            break
        points = igl.arap_solve(values, data, points)
    steps, solution = len(energies), bound.solve(goal)
    NOTES.append(
        f"ARAP, {count}, to a relative change of 1e-3: pliant {solution.iterations} iterations, energy "
        f"{solution.energy:.6g}; libigl (spokes) {steps} iterations, energy {energies[-1]:.6g}."
    )
    rotations, moving = bound.cells.identities(), solution.points.copy()

    def iteration():
        bound.cells.settle(moving, rotations)
        bound.cells.turn(moving, rotations)

    def peer():
        result = mesh.points.copy()
        for _ in range(steps):
            result = igl.arap_solve(values, data, result)
        return result

    return [
        Comparison(
            f"ARAP, {count}: one iteration, ten in a row",
            {"pliant": iteration, "libigl, spokes": lambda: igl.arap_solve(values, data, points)},
            repeat=10,
        ),
        Comparison(f"ARAP, {count}: to 1e-3", {"pliant": lambda: bound.solve(goal), "libigl, spokes": peer}, rounds=2),
    ]


def eigen_comparison() -> Comparison:
    mesh = torus(280, 180)
    stiffness, mass = laplacian(cotangent_weights(mesh.points, mesh.triangles)), masses(mesh.points, mesh.triangles)
    matrix, diagonal = sp.csc_matrix(stiffness), sp.csc_matrix(sp.diags_array(mass))
    values, vectors = lowest_eigenpairs(stiffness, mass, 15)
    residual = np.linalg.norm((stiffness @ vectors - mass[:, None] * vectors * values) / np.sqrt(mass)[:, None], axis=0)
    NOTES.append(
        f"Eigenpairs: largest residual {residual.max():.1e} in the norm of M⁻¹, eigenvalues to {values[-1]:.3f}."
    )
    return Comparison(
        f"first 15 eigenpairs, {len(mass) // 1000}k vertices",
        {
            "pliant": lambda: lowest_eigenpairs(stiffness, mass, 15),
            "SciPy eigsh, sigma=-1e-8": lambda: eigsh(matrix, 15, diagonal, sigma=-1e-8, which="LM"),
        },
        rounds=3,
    )


def transfer_comparison() -> Comparison:
    """Source and target of the sizes of the usual examples; no peer comes as a wheel."""
    source, target = torus(130, 65), torus(219, 100)
    u = np.arange(0, 130, 13)
    markers = np.array(
        [[a * 65 + b, round(a / 130 * 219) % 219 * 100 + round(b / 65 * 100)] for a in u for b in (0, 16, 32, 48)]
    )
    start = time.perf_counter()
    clone = DeformationTransfer(source, target, markers)
    NOTES.append(
        f"Transfer, {len(source.points):,} to {len(target.points):,} vertices: correspondence and set-up "
        f"{time.perf_counter() - start:.1f} s, once."
    )
    pose = source.points * [1.2, 0.9, 1.0]
    return Comparison("transfer of a pose, 8k to 22k vertices", {"pliant": lambda: clone.points(pose)})


if __name__ == "__main__":
    comparisons = [
        *laplacian_comparisons(125, 80),
        *laplacian_comparisons(395, 253),
        *arap_comparisons(125, 80),
        *arap_comparisons(260, 166),
        eigen_comparison(),
        transfer_comparison(),
    ]
    print(report("Surface deformers", comparisons, ["pliant", "numpy", "scipy", "numba", "libigl"], NOTES))
