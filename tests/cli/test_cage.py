"""Cages from the command line: built, checked, and deforming as in the library."""

from __future__ import annotations

import json

import numpy as np
import pytest

import pliant as pl
from pliant.examples import vase


@pytest.fixture
def shape(tmp_path):
    path = tmp_path / "vase.obj"
    pl.write(vase(around=24, along=16), path)
    return path


def test_a_cage_is_built_and_reported(run, shape, tmp_path):
    out = tmp_path / "cage.obj"
    result = run("cage", shape, "--vertices", "60", "-o", out, "--json")
    assert result.exit_code == 0
    report = json.loads(result.stdout)
    cage = pl.read(out)
    assert report["ok"]
    assert report["vertices"] == len(cage.points) <= 60
    assert pl.check_cage(cage, pl.read(shape)).ok
    assert report["volume_ratio"] == pytest.approx(pl.volume(cage) / pl.volume(pl.read(shape)))


def test_boxes_and_own_meshes(run, shape, tmp_path):
    box, small, wide = (tmp_path / name for name in ("box.obj", "small.obj", "wide.obj"))
    assert run("cage", shape, "--method", "box", "--cells", "1x1x3", "--margin", "0.1", "-o", box).exit_code == 0
    cage, mesh = pl.read(box), pl.read(shape)
    assert np.allclose(cage.points, pl.cage_from_box(mesh, (1, 1, 3), 0.1).points)
    pl.write(cage.with_points(mesh.center + 0.7 * (cage.points - mesh.center)), small)
    assert run("cage", shape, "--from", small, "-o", wide).exit_code == 0
    assert pl.check_cage(pl.read(wide), mesh).ok
    assert not pl.check_cage(pl.read(small), mesh).ok


@pytest.mark.parametrize("kind", ["mean-value", "green", "quad-mean-value"])
def test_a_posed_cage_deforms_as_in_the_library(run, shape, tmp_path, kind):
    box, posed, out = (tmp_path / name for name in ("box.obj", "posed.obj", "out.obj"))
    mesh = pl.read(shape)
    cage = pl.cage_from_box(mesh, (1, 1, 2))
    moved = cage.points + np.random.default_rng(0).normal(size=cage.points.shape) * 8
    pl.write(cage, box)
    pl.write(cage.with_points(moved), posed)
    words = ("deform", shape, "--cage", box, "--coordinates", kind, "-o", out)
    assert run(*words, "--posed", posed).exit_code == 0
    deformer = pl.Cage(pl.read(box), coordinates=kind.replace("-", "_"), positions=pl.read(posed).points)
    assert np.allclose(pl.read(out).points, deformer(mesh.points), atol=1e-9)
    assert run(*words, "--move", "3:0,0,9").exit_code == 0
    controls = pl.read(box).points.copy()
    controls[3, 2] += 9
    assert np.allclose(pl.read(out).points, deformer.moved(controls)(mesh.points), atol=1e-9)


def test_wrong_options_are_explained(run, shape, tmp_path):
    box, out = tmp_path / "box.obj", tmp_path / "out.obj"
    pl.write(pl.cage_from_box(pl.read(shape)), box)
    for words, message in (
        (("--posed", box), "there is no cage at rest"),
        (("--cage", box, "--lattice", "4x4x4"), "a cage or a lattice, not both"),
        (("--cage", box, "--posed", shape), "has 8: a posed cage is the same cage"),
        (("--cage", box, "--coordinates", "magic"), "magic"),
    ):
        result = run("deform", shape, *words, "-o", out)
        assert result.exit_code == 2
        assert message in " ".join(result.stderr.replace("│", " ").split())
        assert not out.exists()
    pl.write(
        vase(around=12, along=4).replace(faces=list(vase(around=12, along=4).faces)[:-1], uvs=None, materials=None), box
    )
    result = run("deform", shape, "--cage", box, "-o", out)
    assert result.exit_code != 0
    assert "the cage is open: 12 edges" in result.stderr
