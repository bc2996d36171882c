"""Cages against their peers: `python benchmarks/cage.py`."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from measure import Comparison, report
from pliant.cages.building import build_cage
from pliant.cages.checking import check_cage
from pliant.examples import vase
from pliant.mesh import PolygonMesh
from pliant.space.cage import Cage

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "space"))
from cage_shapes import ball

CAGE = ball(3)  # 512 triangles
POINTS = np.random.default_rng(0).uniform(-0.5, 0.5, (100_000, 3))
PART = 20  # peers take this part of the points: they are slow


def vtk_mean_values(cage: PolygonMesh, points: np.ndarray):
    """VTK takes one point a call."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkMeanValueCoordinatesInterpolator

    corners, triangles = vtkPoints(), vtkCellArray()
    corners.SetData(numpy_to_vtk(np.array(cage.points), deep=True))
    for triangle in cage.triangles.tolist():
        triangles.InsertNextCell(3, triangle)
    weights = np.zeros((len(points), len(cage.points)))

    def work():
        for row, point in zip(weights, points.tolist(), strict=True):
            vtkMeanValueCoordinatesInterpolator.ComputeInterpolationWeights(point, corners, triangles, row)
        return weights

    return work


def numpy_green(cage: PolygonMesh, points: np.ndarray):
    """Green coordinates, triangle by triangle, vectorised over the points."""

    def work():
        phi = np.zeros((len(points), len(cage.points)))
        psi = np.zeros((len(points), len(cage.triangles)))
        for number, triangle in enumerate(cage.triangles):
            corners = cage.points[triangle]
            arms = corners - points[:, None]
            lengths = np.linalg.norm(arms, axis=2)
            normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            double = np.linalg.norm(normal)
            normal /= double
            d = arms[:, 0] @ normal
            total, slanted = np.zeros(len(points)), np.zeros((len(points), 3))
            outwards, sides = [], []
            dots = [(arms[:, i] * arms[:, (i + 1) % 3]).sum(axis=1) for i in range(3)]
            for i in range(3):
                line = corners[(i + 1) % 3] - corners[i]
                side = np.linalg.norm(line)
                out = np.cross(line, normal) / side
                around = lengths[:, i] + lengths[:, (i + 1) % 3]
                logarithm = np.log((around + side) / (around - side))
                total += (arms[:, i] @ out) * logarithm
                slanted += logarithm[:, None] * out
                outwards.append(out)
                sides.append(side)
            solid = lengths.prod(axis=1) + sum(dots[i] * lengths[:, (i + 2) % 3] for i in range(3))
            omega = 2 * np.arctan2(d * double, solid)
            psi[:, number] = (total - d * omega) / (4 * np.pi)
            for k in range(3):
                i = (k + 1) % 3
                height = (arms[:, i] @ outwards[i]) * omega + d * (slanted @ outwards[i])
                phi[:, triangle[k]] += height * sides[i] / double / (4 * np.pi)
        return phi, psi

    return work


def comparisons() -> list[Comparison]:
    mean_value, green = Cage(CAGE), Cage(CAGE, coordinates="green")
    few = POINTS[::PART]
    peer, plain = vtk_mean_values(CAGE, few), numpy_green(CAGE, few)
    assert np.abs(peer() - mean_value.bind(few).matrix()).max() < 1e-9
    assert np.abs(plain()[1] - green.bind(few).tables[1].matrix).max() < 1e-12
    bound, drag = mean_value.bind(POINTS), green.bind(POINTS).drag()
    controls, out = CAGE.points * 1.1, np.empty_like(POINTS)
    one = CAGE.points.copy()

    def drag_one():
        one[7] += 1e-3
        drag.update(one, changed=[(7,)])

    return [
        Comparison(
            f"mean value coordinates, {len(POINTS):,} points × 512 faces",
            {"pliant": lambda: mean_value.bind(POINTS), f"VTK, a {PART}th of the points": peer},
            rounds=3,
        ),
        Comparison(
            f"Green coordinates, {len(POINTS):,} points × 512 faces",
            {
                "pliant": lambda: green.bind(POINTS),
                f"NumPy, a {PART}th of the points": plain,
                f"VTK's mean values, a {PART}th of the points": peer,
            },
            rounds=3,
        ),
        Comparison(
            "bound: all vertices moved (mean value); one vertex dragged (Green)",
            {"pliant, all": lambda: bound.deform(controls, out=out), "pliant, one": drag_one},
        ),
        Comparison(
            "the derivative at 100,000 points, mean value",
            {"pliant": lambda: mean_value.moved(controls).jacobian(POINTS)},
            rounds=3,
        ),
    ]


def memory(kind: str) -> str:
    """What binding takes beyond its result, in a process of its own."""
    program = (
        "import resource, sys; sys.argv = ['x']\n"
        f"sys.path[:0] = {[str(Path(__file__).parent)]!r}\n"
        "import cage\n"
        f"deformer = cage.Cage(cage.CAGE, coordinates={kind!r})\n"
        "deformer.bind(cage.POINTS[:5000])\n"
        "before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "bound = deformer.bind(cage.POINTS)\n"
        "after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "tables = bound.tables if hasattr(bound, 'tables') else [bound.table]\n"
        "size = sum(table.matrix.nbytes for table in tables)\n"
        "print(f'{(after - before) / 1024:.0f} MB, of which the result {size / 2**20:.0f} MB')\n"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return f"{kind}: binding grew the process by {found.stdout.strip()}."


def building(meshes: list[Path]) -> list[str]:
    """Seconds and tightness of cages of 150 vertices."""
    shapes = {"vase": vase()}
    if meshes:
        from pliant.io.meshes import read

        shapes |= {path.stem: read(path) for path in meshes}
    build_cage(vase(around=16, along=8), 40)
    lines = ["", "| cage of 150 vertices | points | seconds | volume ratio | passes |", "|---|--:|--:|--:|---|"]
    for name, mesh in shapes.items():
        start = time.perf_counter()
        cage = build_cage(mesh, 150)
        seconds = time.perf_counter() - start
        found = check_cage(cage, mesh)
        ratio = "open" if found.volume_ratio is None else f"{found.volume_ratio:.2f}"
        lines.append(f"| {name} | {len(mesh.points):,} | {seconds:.1f} | {ratio} | {'yes' if found.ok else 'no'} |")
    return lines


if __name__ == "__main__":
    notes = [memory("mean_value"), memory("green"), *building([Path(word) for word in sys.argv[1:]])]
    sys.argv = sys.argv[:1]
    print(report("Cages", comparisons(), ["pliant", "numpy", "numba", "vtk", "libigl"], notes))
