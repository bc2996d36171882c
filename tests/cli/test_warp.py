"""``pliant warp`` and what ``info`` says of medical files."""

from __future__ import annotations

import json

import numpy as np
import pytest

import pliant as pl
from pliant.field.resampling import warp_image
from pliant.io.images import Image, read_image, write_image
from pliant.space.compose import compose


@pytest.fixture
def files(tmp_path):
    values = np.random.default_rng(0).normal(size=(8, 9, 10)).astype(np.float32)
    write_image(Image(values, np.array([1.0, 2, 3]), np.array([1.0, 2, 1.5])), tmp_path / "scan.nii.gz")
    moves = np.random.default_rng(1).normal(size=(6, 6, 6, 3)) * 0.3
    ffd = pl.BSplineFFD(displacements=moves, origin=(-5, -5, -5), spacing=(5, 5, 5), edge="identity")
    pl.write_transform(ffd, tmp_path / "map.tfm")
    return tmp_path


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_warps(run, files, interpolation):
    scan, out = files / "scan.nii.gz", files / "out.mha"
    result = run("warp", scan, "-t", files / "map.tfm", "-o", out, "--interpolation", interpolation, "--json")
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["voxels"] == [8, 9, 10]
    expected = warp_image(read_image(scan), pl.read_transform(files / "map.tfm"), interpolation=interpolation)
    assert np.array_equal(read_image(out).values, expected.values)


def test_there_and_back(run, files):
    scan, there, back = files / "scan.nii.gz", files / "there.nii", files / "back.nii"
    smooth = read_image(scan)
    ramp = np.add.outer(np.add.outer(np.arange(8.0), np.arange(9.0)), np.arange(10.0))
    write_image(Image(ramp, smooth.origin, smooth.spacing), scan)
    assert run("warp", scan, "-t", files / "map.tfm", "-o", there).exit_code == 0
    assert run("warp", there, "-t", files / "map.tfm", "-o", back, "--inverse").exit_code == 0
    off = np.abs(read_image(back).values - ramp)[2:-2, 2:-2, 2:-2]
    assert off.max() < 0.1
    assert np.abs(read_image(there).values - ramp)[2:-2, 2:-2, 2:-2].max() > 0.1


def test_what_is_no_image(run, files, cube):
    result = run("warp", cube, "-t", files / "map.tfm", "-o", files / "out.nii")
    assert result.exit_code != 0
    assert "no image that pliant reads" in result.stderr


def told(run, path):
    result = run("info", "--json", path)
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)


def test_conventions_are_told(run, files):
    facts = told(run, files / "map.tfm")
    assert facts["format"] == "ITK text"
    assert (facts["direction"], facts["edge"], facts["outside"]) == ("pull-back", "identity", "nothing moves")
    assert facts["space"].startswith("LPS")
    assert "first index fastest" in facts["values"]
    assert facts["transforms"] == "BSplineTransform_double_3_3"
    assert facts["control_points"] == [6, 6, 6]
    ffd = pl.read_transform(files / "map.tfm")
    pl.write_transform(compose(pl.Affine.rotation("x", 0.1), ffd), files / "two.h5")
    assert told(run, files / "two.h5")["parts"] == ["Affine", "BSplineFFD"]
    image = told(run, files / "scan.nii.gz")
    assert (image["kind"], image["voxels"], image["type"]) == ("image", [8, 9, 10], "float32")


def test_converts_the_inverse(run, files):
    out = files / "back.dof.gz"
    result = run("convert", files / "map.tfm", out, "--inverse", "--lattice", "20x20x20", "--json")
    assert result.exit_code == 0, result.stderr
    assert "off by" in json.loads(result.stdout)["losses"][0]
    points = np.random.default_rng(0).uniform(2, 13, (50, 3))
    there = pl.read_transform(files / "map.tfm")(points)
    assert np.abs(pl.read_transform(out)(there) - points).max() < 0.02


def test_a_mesh_in_lps_moves_as_itk_moves_its_points(run, files, cube):
    import SimpleITK as sitk  # noqa: N813

    out = files / "moved.obj"
    result = run("deform", cube, "--ffd", files / "map.tfm", "--mesh-space", "LPS", "-o", out)
    assert result.exit_code == 0, result.stderr
    transform = sitk.ReadTransform(str(files / "map.tfm"))
    expected = [transform.TransformPoint(point) for point in pl.read(cube).points.tolist()]
    assert np.abs(pl.read(out).points - expected).max() < 1e-9
