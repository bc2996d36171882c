"""Transforms against their peers: `python benchmarks/transforms.py`."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import SimpleITK as sitk  # noqa: N813

import pliant as pl
from measure import Comparison, report

RANDOM = np.random.default_rng(0)
POINTS = RANDOM.random((1_000_000, 3))
BOX = np.array([[0.0, 0, 0], [1, 1, 1]])
SIGNS = np.array([-1.0, -1, 1])
FOLDER = Path(tempfile.mkdtemp(prefix="pliant-benchmark-"))


def lattice():
    """8 x 8 x 8 control points around the unit box, with the room that ITK's border needs."""
    ffd = pl.BSplineFFD.around(BOX, shape=(8, 8, 8), margin=0.25, edge="identity")
    return ffd.moved(ffd.rest + RANDOM.normal(size=ffd.rest.shape) * 0.01)


def itk_field(transform, count):
    """ITK's own filter: the transform at a regular grid of count³ points of the box, in all threads."""
    spacing = 1 / (count - 1)
    return lambda: sitk.TransformToDisplacementField(
        transform, sitk.sitkVectorFloat64, (count,) * 3, (-1.0, -1.0, 0.0), (spacing,) * 3
    )


def itk_points(transform):
    """Point by point, the only way that SimpleITK offers for points anywhere."""
    triples = (POINTS * SIGNS).tolist()
    return lambda: [transform.TransformPoint(point) for point in triples]


def vtk_grid(ffd, count, kind):
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersHybrid import vtkBSplineTransform, vtkTransformToGrid

    image = vtkImageData()
    image.SetDimensions(*ffd.shape)
    image.SetSpacing(*ffd.spacing)
    image.SetOrigin(*ffd.origin)
    flat = np.ascontiguousarray(ffd.displacements.transpose(2, 1, 0, 3)).reshape(-1, 3)
    image.GetPointData().SetScalars(numpy_to_vtk(flat, deep=1))
    transform = vtkBSplineTransform()
    transform.SetCoefficientData(image)

    def run():
        grid = vtkTransformToGrid()
        grid.SetInput(transform)
        grid.SetGridExtent(0, count - 1, 0, count - 1, 0, count - 1)
        grid.SetGridSpacing(*(1 / (count - 1),) * 3)
        getattr(grid, f"SetGridScalarTypeTo{kind}")()
        grid.Update()
        return grid.GetOutput()

    return run


def comparisons():
    ffd = lattice()
    pl.write_transform(ffd, FOLDER / "map.tfm")
    ours, theirs = pl.read_transform(FOLDER / "map.tfm"), sitk.ReadTransform(str(FOLDER / "map.tfm"))
    some = POINTS[:1000]
    expected = np.array([theirs.TransformPoint(point) for point in (some * SIGNS).tolist()]) * SIGNS
    assert np.abs(ours(some) - expected).max() < 1e-12
    grid = pl.to_grid(ffd, BOX, shape=(128,) * 3)
    field = sitk.GetArrayFromImage(itk_field(theirs, 128)())[:, ::-1, ::-1].transpose(2, 1, 0, 3) * SIGNS
    inner = (slice(1, -1),) * 3
    assert np.abs(field - grid.displacements)[inner].max() < 1e-12
    pl.write_transform(grid, FOLDER / "field.h5")
    ours_field, theirs_field = pl.read_transform(FOLDER / "field.h5"), sitk.ReadTransform(str(FOLDER / "field.h5"))
    return [
        Comparison(
            "an ITK B-spline, 8³ control points, at 1M points",
            {
                "pliant, points anywhere": lambda: ours(POINTS),
                "SimpleITK, its filter, regular points": itk_field(theirs, 100),
                "SimpleITK, points anywhere": itk_points(theirs),
            },
            rounds=3,
        ),
        Comparison(
            "the same as a dense displacement grid of 128³",
            {
                "pliant, separable": lambda: pl.to_grid(ffd, BOX, shape=(128,) * 3),
                "VTK, double": vtk_grid(ffd, 128, "Double"),
                "VTK, float": vtk_grid(ffd, 128, "Float"),
                "SimpleITK": itk_field(theirs, 128),
            },
            rounds=5,
        ),
        Comparison(
            "an ITK displacement field of 128³, linear, at 1M points",
            {
                "pliant, points anywhere": lambda: ours_field(POINTS),
                "SimpleITK, its filter, regular points": itk_field(theirs_field, 100),
            },
            rounds=5,
        ),
        Comparison(
            "reading that field from HDF5",
            {
                "pliant": lambda: pl.read_transform(FOLDER / "field.h5"),
                "SimpleITK": lambda: sitk.ReadTransform(str(FOLDER / "field.h5")),
            },
            rounds=5,
        ),
    ]


if __name__ == "__main__":
    print(report("Transforms", comparisons(), ["pliant", "numpy", "numba", "SimpleITK", "vtk"]))
