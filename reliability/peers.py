"""Where other programs do the same thing, they must agree: `python -m reliability.peers --cases 200`.

VTK's B-spline and thin-plate transforms, ITK's B-spline transform, libigl's as-rigid-as-possible deformation.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import pliant as pl
from reliability.ledger import publish

Floats = NDArray[np.float64]
RAS = np.array([-1.0, -1.0, 1.0])


def lattice(random: np.random.Generator) -> tuple[pl.BSplineFFD, Floats]:
    """A lattice of any size, and points where it has all that the basis sums."""
    shape = random.integers(4, 9, 3)
    spacing = 10.0 ** random.uniform(-2, 2) * random.uniform(0.5, 2, 3)
    origin = spacing * random.normal(size=3) * 5
    moves = 0.3 * spacing * random.normal(size=(*shape, 3))
    ffd = pl.BSplineFFD(displacements=moves, origin=origin, spacing=spacing, edge="zero")
    return ffd, origin + spacing * random.uniform(1, shape - 2, (60, 3))


def vtk_bspline(random: np.random.Generator) -> float:
    """How far VTK's B-spline transform is from ours, relative to the points' extent."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersHybrid import vtkBSplineTransform

    ffd, points = lattice(random)
    image: Any = vtkImageData()
    image.SetDimensions(*ffd.displacements.shape[:3])
    image.SetOrigin(*ffd.origin)
    image.SetSpacing(*ffd.spacing)
    values = np.ascontiguousarray(ffd.displacements.transpose(2, 1, 0, 3).reshape(-1, 3))
    image.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
    transform: Any = vtkBSplineTransform()
    transform.SetCoefficientData(image)
    transform.SetBorderModeToZero()
    return _off(ffd(points), [transform.TransformPoint(*point) for point in points], points)


def vtk_thin_plate(random: np.random.Generator) -> float:
    """How far VTK's thin-plate spline is from ours."""
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonTransforms import vtkThinPlateSplineTransform

    size = 10.0 ** random.uniform(-2, 2)
    marks = size * random.normal(size=(15, 3))
    goals = marks + 0.1 * size * random.normal(size=marks.shape)
    transform: Any = vtkThinPlateSplineTransform()
    transform.SetBasisToR()
    for rows, give in ((marks, transform.SetSourceLandmarks), (goals, transform.SetTargetLandmarks)):
        landmarks = vtkPoints()
        landmarks.SetDataTypeToDouble()
        for row in rows:
            landmarks.InsertNextPoint(*row)
        give(landmarks)
    points = size * random.normal(size=(60, 3))
    ours = pl.ThinPlateSpline(marks, goals)(points)
    return _off(ours, [transform.TransformPoint(*point) for point in points], points)


def itk_bspline(random: np.random.Generator) -> float:
    """How far ITK's B-spline transform, read from a file that pliant wrote, is from ours."""
    import SimpleITK

    ffd, points = lattice(random)
    with tempfile.TemporaryDirectory(prefix="pliant-peers-") as folder:
        pl.write_transform(ffd, Path(folder, "a.tfm"))
        transform = SimpleITK.ReadTransform(str(Path(folder, "a.tfm")))
    theirs = [np.array(transform.TransformPoint((point * RAS).tolist())) * RAS for point in points]
    return _off(ffd(points), theirs, points)


def igl_arap(random: np.random.Generator) -> float:
    """How far libigl's as-rigid-as-possible deformation is from ours, both at rest from one beginning."""
    import igl

    rings, around = 12, 10
    height, angle = np.linspace(0, 4, rings), np.linspace(0, 2 * np.pi, around, endpoint=False)
    wide = 0.5 + 0.1 * np.sin(random.uniform(1, 3) * height)[:, None]
    tops = np.broadcast_to(height[:, None], (rings, around))
    points = np.stack([wide * np.cos(angle), wide * np.sin(angle), tops], axis=-1).reshape(-1, 3)
    quads = np.array([[r * around + s, r * around + (s + 1) % around, (r + 1) * around + (s + 1) % around,
                       (r + 1) * around + s] for r in range(rings - 1) for s in range(around)])  # fmt: skip
    mesh = pl.PolygonMesh(points, np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))
    roi, handle = np.flatnonzero(points[:, 2] > 1.0), np.flatnonzero(points[:, 2] > 3.3)
    bound = pl.ARAP(roi, handle, tolerance=1e-14, iterations=5000).bind(mesh)
    goal = bound.rest + 0.3 * random.uniform(-1, 1, 3)
    fixed = np.setdiff1d(np.arange(len(points)), bound.constraints.free)
    places = points.copy()
    places[handle] = goal
    data = igl.ARAPData()
    data.max_iter, data.energy = 5000, igl.ARAPEnergyType.ARAP_ENERGY_TYPE_SPOKES
    igl.arap_precomputation(points, mesh.triangles.astype(np.int64), 3, fixed.astype(np.int32), data)
    theirs = igl.arap_solve(np.ascontiguousarray(places[fixed]), data, points.copy())
    return _off(bound.deform(goal), theirs, points)


def _off(ours: Floats, theirs: Any, points: Floats) -> float:
    return float(np.abs(ours - np.asarray(theirs)).max() / np.linalg.norm(np.ptp(points, axis=0)))


PEERS: dict[str, tuple[Callable[[np.random.Generator], float], float, float]] = {  # and the limit; a share of the cases
    "VTK: vtkBSplineTransform": (vtk_bspline, 1e-12, 1.0),
    "VTK: vtkThinPlateSplineTransform, phi = r": (vtk_thin_plate, 1e-9, 1.0),
    "SimpleITK: BSplineTransform, through a file": (itk_bspline, 1e-12, 1.0),
    "libigl: ARAP, spokes": (igl_arap, 1e-3, 0.05),
}


def figures(cases: int) -> dict[str, Any]:
    """Ask every peer."""
    rows = []
    for name, (ask, limit, share) in PEERS.items():
        found = [ask(np.random.default_rng(seed)) for seed in range(max(1, round(share * cases)))]
        agree = sum(off <= limit for off in found)
        rows.append({"peer": name, "cases": len(found), "agree": agree, "limit": limit, "worst": max(found)})
    return {"cases": sum(row["cases"] for row in rows), "disagreements": sum(
        row["cases"] - row["agree"] for row in rows), "peers": rows}  # fmt: skip


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=200)
    publish("peers", figures(parser.parse_args().cases))


if __name__ == "__main__":
    main()
