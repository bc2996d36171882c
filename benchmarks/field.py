"""Inverses against VTK, and what proofs cost: `python benchmarks/field.py`."""

from __future__ import annotations

import numpy as np

import pliant as pl
from measure import Comparison, report

RANDOM = np.random.default_rng(0)
POINTS = RANDOM.random((100_000, 3))


def shaken(lattice, strength):
    """A lattice whose control points leave their places by a share of their distance, normally distributed."""
    return lattice.moved(lattice.rest + strength * lattice.spacing * RANDOM.normal(size=lattice.rest.shape))


def inverse_comparison() -> Comparison:
    """A hundred thousand points back through 8 x 8 x 8 spans, to the same absolute tolerance."""
    lattice = shaken(pl.BSplineFFD.around(POINTS, shape=(9, 9, 9)), 0.15)
    images = lattice(POINTS)
    tolerance = 1e-10 / float(np.linalg.norm(np.ptp(images, axis=0)))
    peer = vtk_inverse(lattice, images)
    for name, found in (("pliant", lattice.inverse(images, tolerance=tolerance)), ("VTK", peer())):
        assert np.linalg.norm(lattice(found) - images, axis=1).max() <= 1e-10, name
    return Comparison(
        "inverse of a cubic B-spline, 8³ spans, 100,000 points to 1e-10",
        {"pliant": lambda: lattice.inverse(images, tolerance=tolerance), "VTK": peer},
    )


def proof_comparison() -> Comparison:
    """Bounds of det J over all 11 x 11 x 11 cells of the support, against looking at samples that prove nothing."""
    lattice = shaken(pl.BSplineFFD.around(POINTS, shape=(10, 10, 10)), 0.1)
    strong = shaken(pl.BSplineFFD.around(POINTS, shape=(10, 10, 10)), 0.6)
    assert pl.certify(lattice).status == "fold-free"
    assert pl.certify(strong).status == "folds"
    return Comparison(
        "10 x 10 x 10 control points, random",
        {
            "certify: a proof, bounds to 1 %": lambda: pl.certify(lattice),
            "certify: a fold found": lambda: pl.certify(strong),
            "limit_to_fold_free": lambda: pl.limit_to_fold_free(strong),
            "det J at 100,000 samples": lambda: pl.volume_ratio(lattice, POINTS),
        },
        rounds=5,
    )


def vtk_inverse(lattice, images):
    """vtkBSplineTransform as shipped, to the same tolerance."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersHybrid import vtkBSplineTransform

    image = vtkImageData()
    image.SetDimensions(*lattice.shape)
    image.SetSpacing(*lattice.spacing)
    image.SetOrigin(*lattice.origin)
    flat = np.ascontiguousarray(lattice.displacements.transpose(2, 1, 0, 3)).reshape(-1, 3)
    image.GetPointData().SetScalars(numpy_to_vtk(flat, deep=1))
    transform = vtkBSplineTransform()
    transform.SetCoefficientData(image)
    transform.SetBorderModeToEdge()
    transform.SetInverseTolerance(1e-10)
    transform.SetInverseIterations(500)
    transform.Inverse()

    def run():
        given, found = vtkPoints(), vtkPoints()
        given.SetData(numpy_to_vtk(images))
        found.SetDataTypeToDouble()
        transform.TransformPoints(given, found)
        return vtk_to_numpy(found.GetData())

    return run


if __name__ == "__main__":
    print(
        report(
            "Looking at deformations", [inverse_comparison(), proof_comparison()], ["pliant", "numpy", "numba", "vtk"]
        )
    )
