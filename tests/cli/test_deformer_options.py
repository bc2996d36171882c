"""Deformers on the command line: their options are their fields, and their order is that of the deformations."""

from __future__ import annotations

import numpy as np
import pytest

import pliant as pl
from pliant.cli.deformer_options import deformers


@pytest.fixture
def deformed(run, cube, tmp_path):
    """The cube's points after ``pliant deform`` with some words."""

    def call(*words):
        out = tmp_path / "out.obj"
        done = run("deform", cube, *words, "-o", out)
        assert done.exit_code == 0, done.stderr
        return pl.read(out).points

    return call


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--twist", "axis=z,angle=90,bounds=2:8"], lambda m: pl.Twist.around(m, angle=np.pi / 2, bounds=(2, 8))),
        (["--twist=angle=-45,axis=1:1:0"], lambda m: pl.Twist.around(m, axis=[1, 1, 0], angle=-np.pi / 4)),
        (["--bend", "axis=y,angle=30,normal=z"], lambda m: pl.Bend.around(m, axis="y", angle=np.pi / 6, normal="z")),
        (["--taper", "factor=0.5,profile=smooth"], lambda m: pl.Taper.around(m, factor=0.5, profile="smooth")),
        (
            ["--taper", "factor=2,profile=0:0/0.5:1/1:0"],
            lambda m: pl.Taper.around(m, factor=2, profile=[(0, 0), (0.5, 1), (1, 0)]),
        ),
        (["--scale", "x=2,z=0.5,origin=1:2:3"], lambda m: pl.Scale(x=2, z=0.5, origin=(1, 2, 3))),
        (["--flare", "start=2,bulge=0.5"], lambda m: pl.Flare.around(m, start=2, bulge=0.5)),
        (
            ["--sine", "amplitude=1,waves=2,phase=90"],
            lambda m: pl.Sine.around(m, amplitude=1, waves=2, phase=np.pi / 2),
        ),
        (["--wave", "amplitude=1,axis=y"], lambda m: pl.Wave.around(m, amplitude=1, axis="y")),
        (["--squash", "factor=0.6"], lambda m: pl.Squash.around(m, factor=0.6)),
    ],
)
def test_an_option_is_the_deformer_around_the_mesh(deformed, cube, words, expected):
    mesh = pl.read(cube)
    assert np.allclose(deformed(*words), expected(mesh)(mesh.points), atol=1e-12)


def test_they_are_composed_in_the_order_of_the_line(deformed, cube):
    mesh = pl.read(cube)
    twist, taper = pl.Twist.around(mesh, angle=np.pi / 2), pl.Taper.around(mesh, axis="x", factor=0.5)
    lattice = pl.BSplineFFD.around(mesh, shape=(3, 3, 3))
    controls = lattice.rest.copy()
    controls[2, 2, 2] += 1
    lattice = lattice.moved(controls)
    one, two = ("--twist", "angle=90"), ("--taper", "axis=x,factor=0.5")
    middle = ("--lattice", "3x3x3", "--move", "2,2,2:1,1,1")
    assert np.allclose(deformed(*one, *two), taper(twist(mesh.points)), atol=1e-12)
    assert np.allclose(deformed(*two, *one), twist(taper(mesh.points)), atol=1e-12)
    assert np.allclose(deformed(*one, *middle, *two), taper(lattice(twist(mesh.points))), atol=1e-12)
    assert np.allclose(deformed(*middle, *one, *one), twist(twist(lattice(mesh.points))), atol=1e-12)


def test_the_inverse_undoes_them_all(run, deformed, cube, tmp_path):
    there, back = tmp_path / "there.obj", tmp_path / "back.obj"
    words = ("--bend", "angle=20,bounds=0:10,origin=5:5:5", "--twist", "angle=50,bounds=0:10,origin=5:5:5")
    assert run("deform", cube, *words, "-o", there).exit_code == 0
    assert run("deform", there, *words, "--inverse", "-o", back).exit_code == 0
    assert np.allclose(pl.read(back).points, pl.read(cube).points, atol=1e-6)


def test_every_deformer_that_numbers_control_has_an_option_and_help(run):
    assert {"twist", "taper", "bend", "scale", "flare", "sine", "wave", "squash"} <= set(deformers())
    told = " ".join(run("deform", "--help").stdout.split())
    for name, kind in deformers().items():
        assert f"--{name} FIELD=VALUE" in told
        assert all(f"{parameter}=" in told for parameter in kind.parameters)


@pytest.mark.parametrize(
    ("words", "cause"),
    [
        (["--twist", "angel=3"], "'angel=3' is no field"),
        (["--twist", "angle"], "'angle' is no field"),
        (["--twist", "angle=x:2"], "no number"),
        (["--twist", ""], "say how"),
        (["--twist"], "say how"),
        (["--twits", "angle=3"], "No such option"),
    ],
)
def test_wrong_usage_is_told(run, cube, tmp_path, words, cause):
    result = run("deform", cube, *words, "-o", tmp_path / "out.obj")
    assert result.exit_code == 2
    assert cause in " ".join(result.stderr.split())
    assert not (tmp_path / "out.obj").exists()


def test_a_deformer_that_cannot_be_is_refused_with_its_reason(run, cube, tmp_path):
    result = run("deform", cube, "--twist", "angle=3,bounds=2:1", "-o", tmp_path / "out.obj")
    assert result.exit_code not in (0, 1)
    assert "reversed" in result.stderr
