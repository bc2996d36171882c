"""elastix's files: what their text says, computed by SimpleITK; and ours, which read back as they were."""

from __future__ import annotations

import numpy as np
import pytest
import SimpleITK as sitk  # noqa: N813

import pliant as pl
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.space.compose import compose
from pliant.space.summed import Summed

SIGNS = np.array([-1.0, -1, 1])
AXES = pl.Affine.rotation((1, -2, 3), 0.6).linear
RANDOM = np.random.default_rng(0)
VALUES = RANDOM.normal(size=3 * 6 * 5 * 7) * 0.3


def numbers(values):
    return " ".join(repr(float(value)) for value in values)


def grid_text(before="NoInitialTransform", how="Compose", direction=AXES):
    return f"""// elastix writes comments
(Transform "BSplineTransform")
(NumberOfParameters {len(VALUES)})
(TransformParameters {numbers(VALUES)})
(InitialTransformParametersFileName "{before}")
(HowToCombineTransforms "{how}")
(GridSize 6 5 7)
(GridIndex 0 0 0)
(GridSpacing 2.0 3.0 1.5)
(GridOrigin 1.0 2.0 3.0)
(GridDirection {numbers(direction.T.reshape(-1))})
(BSplineTransformSplineOrder 3)
(UseCyclicTransform "false")
"""


EULER = """(Transform "EulerTransform")
(NumberOfParameters 6)
(TransformParameters 0.1 -0.2 0.3 4 5 6)
(CenterOfRotationPoint 1 2 3)
(ComputeZYX "false")
(InitialTransformParametersFileName "NoInitialTransform")
"""


def spline():
    transform = sitk.BSplineTransform(3, 3)
    transform.SetFixedParameters([6, 5, 7, 1, 2, 3, 2, 3, 1.5, *AXES.reshape(-1)])
    transform.SetParameters(VALUES.tolist())
    return transform


def euler():
    return sitk.Euler3DTransform((1, 2, 3), 0.1, -0.2, 0.3, (4, 5, 6))


def by_itk(transform, points):
    return np.array([transform.TransformPoint(point) for point in (points * SIGNS).tolist()]) * SIGNS


def points(beyond=2):
    q = np.random.default_rng(1).uniform(-beyond, np.array([5, 4, 6]) + beyond, (400, 3))
    return ([1, 2, 3] + q * [2, 3, 1.5] @ AXES.T) * SIGNS


def test_a_lattice(tmp_path):
    path = tmp_path / "TransformParameters.0.txt"
    path.write_text(grid_text())
    assert np.abs(pl.read_transform(path)(points()) - by_itk(spline(), points())).max() < 1e-12


@pytest.mark.parametrize("how", ["Compose", "Add"])
@pytest.mark.parametrize(
    "before", ["TransformParameters.0.txt", "/elsewhere/TransformParameters.0.txt", "C:\\a\\TransformParameters.0.txt"]
)
def test_a_chain_lies_in_one_folder(tmp_path, how, before):
    (tmp_path / "TransformParameters.0.txt").write_text(EULER)
    path = tmp_path / "TransformParameters.1.txt"
    path.write_text(grid_text(before, how))
    x = points()
    first, second = by_itk(euler(), x), by_itk(spline(), x)
    expected = by_itk(spline(), first) if how == "Compose" else first + second - x
    assert np.abs(pl.read_transform(path)(x) - expected).max() < 1e-12


def lattice(edge="zero", affine=None):
    values = np.random.default_rng(2).normal(size=(6, 5, 4, 3)) * 0.3
    affine = np.eye(4) if affine is None else affine
    return pl.BSplineFFD(
        displacements=values, origin=(1, 2, 3), spacing=(2, 3, 1.5), axes=AXES, edge=edge, affine=affine
    )


def test_ours(tmp_path):
    affine = np.eye(4)
    affine[:3] += RANDOM.normal(size=(3, 4)) * 0.1
    path, x = tmp_path / "TransformParameters.0.txt", points()
    for deformer in (
        pl.Affine(affine),
        lattice(),
        lattice("identity"),
        lattice(affine=affine),
        compose(pl.Affine(affine), lattice(), lattice("identity")),
        Summed((lattice(), lattice("identity"))),
    ):
        report = pl.write_transform(deformer, path, strict=True)
        assert any("image geometry" in note for note in report.notes)
        assert np.abs(pl.read_transform(path)(x) - deformer(x)).max() < 1e-12
    assert (tmp_path / "TransformParameters.0.before0.txt").exists()


def test_what_elastix_cannot_hold(tmp_path):
    path = tmp_path / "TransformParameters.0.txt"
    assert "beyond the lattice" in pl.write_transform(lattice("clamp"), path).losses[0]
    with pytest.raises(UnsupportedFormat, match="BezierFFD"):
        pl.write_transform(pl.BezierFFD.around(np.eye(3)), path)


@pytest.mark.parametrize(
    ("text", "error", "message"),
    [
        (grid_text().replace("GridSize 6 5 7", "GridSize 6 5 8"), UnreadableFile, "630 parameters"),
        (grid_text().replace("GridSize", "Size"), UnreadableFile, "GridSize"),
        (grid_text().replace("SplineOrder 3", "SplineOrder 2"), UnsupportedFormat, "order"),
        (grid_text().replace('"false"', '"true"'), UnsupportedFormat, "Cyclic"),
        (grid_text(direction=np.ones((3, 3))), UnreadableFile, "orthonormal"),
        (grid_text("TransformParameters.1.txt"), UnreadableFile, "circle"),
        (grid_text("TransformParameters.7.txt"), UnreadableFile, "No such file"),
        (grid_text("TransformParameters.0.txt", "Sum"), UnreadableFile, "Compose or Add"),
        (EULER.replace("0.1 -0.2", "0.1"), UnreadableFile, "line 3: .*5 numbers"),
        (EULER.replace("Euler", "Weighted"), UnsupportedFormat, "Weighted"),
        (EULER.replace("0.1", "inf"), UnreadableFile, "inf"),
    ],
)
def test_damaged_files(tmp_path, text, error, message):
    (tmp_path / "TransformParameters.0.txt").write_text(EULER)
    path = tmp_path / "TransformParameters.1.txt"
    path.write_text(text)
    with pytest.raises(error, match=message):
        pl.read_transform(path)
