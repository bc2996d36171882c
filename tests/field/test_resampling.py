"""Images through maps: what SimpleITK's resampler computes, linear and cubic, on other grids, of every type."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import SimpleITK as sitk  # noqa: N813

import pliant as pl
from pliant.errors import InvalidParameter
from pliant.field.resampling import warp_image
from pliant.io.images import Image, read_image, write_image

AXES = pl.Affine.rotation((1, -2, 3), 0.4).linear
KINDS = {"linear": sitk.sitkLinear, "cubic": sitk.sitkBSpline}


def scan(dtype=np.float64, shape=(14, 12, 10), channels=()):
    values = np.random.default_rng(0).normal(size=(*shape, *channels)) * 100
    values = values if np.dtype(dtype).kind == "f" else np.clip(values, np.iinfo(dtype).min, np.iinfo(dtype).max)
    return Image(values.astype(dtype), np.array([1.0, -2, 3]), np.array([1.5, 2, 3]), AXES)


def bent(direction="pull-back"):
    values = np.random.default_rng(1).normal(size=(8, 8, 8, 3))
    return pl.BSplineFFD(
        displacements=values, origin=(-15, -15, -15), spacing=(9, 9, 9), edge="identity", direction=direction
    )


def by_itk(tmp_path, image, deformer, reference, kind, fill=0.0):
    write_image(image, tmp_path / "image.mha")
    write_image(reference, tmp_path / "reference.mha")
    pl.write_transform(deformer, tmp_path / "map.tfm")
    source, grid = (sitk.ReadImage(str(tmp_path / name)) for name in ("image.mha", "reference.mha"))
    transform = sitk.ReadTransform(str(tmp_path / "map.tfm"))
    result = sitk.Resample(source, grid, transform, KINDS[kind], fill, source.GetPixelID())
    values = sitk.GetArrayFromImage(result)
    return values.transpose(2, 1, 0, *range(3, values.ndim))


@pytest.mark.parametrize(("kind", "channels"), [("linear", ()), ("linear", (2,)), ("cubic", ())])
def test_agrees_with_itk(tmp_path, kind, channels):
    image = scan(channels=channels)
    other = Image(np.zeros((9, 11, 13)), np.array([0.0, 1, 2]), np.array([2.0, 1.5, 2.5]), np.eye(3))
    for reference in (image, other):
        ours = warp_image(image, bent(), reference=reference, interpolation=kind, fill=-7.0)
        theirs = by_itk(tmp_path, image, bent(), reference, kind, -7.0)
        assert (theirs == -7.0).any() == (reference is other)
        assert np.abs(ours.values - theirs).max() <= 1e-6 * np.abs(theirs).max()


@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.float32])
def test_types_are_kept_and_whole_numbers_rounded_where_itk_cuts_them_off(tmp_path, dtype):
    image = scan(dtype)
    ours = warp_image(image, bent())
    exact = warp_image(replace(image, values=image.values.astype(np.float64)), bent()).values
    theirs = by_itk(tmp_path, image, bent(), image, "linear")
    assert ours.values.dtype == dtype
    assert np.abs(ours.values - exact).max() <= (1e-4 if dtype == np.float32 else 0.5)
    assert np.abs(ours.values.astype(float) - theirs).max() <= (1e-4 if dtype == np.float32 else 1)


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_voxels_stay_under_the_identity(interpolation):
    image = scan()
    assert np.abs(warp_image(image, pl.Affine(), interpolation=interpolation).values - image.values).max() < 1e-10


def test_linear_images_are_moved_exactly(random):
    """The value at x is that at T(x): for v(x) = n . x, and T affine, n . T(x)."""
    image = scan()
    index = np.stack(np.meshgrid(*map(np.arange, image.shape), indexing="ij"), axis=-1)
    places = image.origin + (index * image.spacing) @ image.axes.T
    normal = np.array([1.0, 2, -3])
    ramp = Image(places @ normal, image.origin, image.spacing, image.axes)
    turn = pl.Affine.rotation((0, 0, 1), 0.05, places.mean(axis=(0, 1, 2)))
    moved = warp_image(ramp, turn, fill=np.nan).values
    assert np.isfinite(moved[3:-3, 3:-3, 3:-3]).all()
    expected = (turn(places.reshape(-1, 3)) @ normal).reshape(moved.shape)
    assert np.abs(moved - expected)[3:-3, 3:-3, 3:-3].max() < 1e-11


@pytest.mark.parametrize("name", ["a.nii", "a.nii.gz", "a.mha", "a.mhd"])
@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.float32, np.float64])
def test_images_go_both_ways_and_lie_where_itk_sees_them(tmp_path, name, dtype):
    image, path = scan(dtype), tmp_path / name
    write_image(image, path)
    again = read_image(path)
    assert again.values.dtype == dtype
    assert np.array_equal(again.values, image.values)
    assert np.allclose(again.origin, image.origin, atol=1e-5)
    assert np.allclose(again.axes * again.spacing, image.axes * image.spacing, atol=1e-5)
    seen = sitk.ReadImage(str(path))
    corner = np.array(seen.TransformIndexToPhysicalPoint((3, 2, 1))) * [-1, -1, 1]
    assert np.allclose(corner, image.origin + image.axes @ (image.spacing * [3, 2, 1]), atol=1e-4)
    assert np.isclose(seen[3, 2, 1], float(image.values[3, 2, 1]))


def test_another_interpolation_is_refused():
    with pytest.raises(InvalidParameter, match="nearest"):
        warp_image(scan(), pl.Affine(), interpolation="nearest")
