"""``pliant info`` and ``convert``: what is told is true."""

from __future__ import annotations

import json

import numpy as np
import pytest

import pliant as pl


def told(run, *words):
    result = run("info", "--json", *words)
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)


def test_a_closed_mesh(run, cube):
    facts = told(run, cube)
    assert (facts["points"], facts["faces"], facts["corners_a_face"]) == (8, 6, {"4": 6})
    assert (facts["closed"], facts["boundary_edges"], facts["non_manifold_edges"]) == (True, 0, 0)
    assert (facts["lowest"], facts["highest"], facts["size"]) == ([0, 0, 0], [10, 10, 10], [10, 10, 10])
    assert {"uvs", "normals", "groups", "objects"} <= set(facts["carries"])


def test_an_open_mesh_with_a_loose_point(run, cube):
    lines = cube.read_text().splitlines()
    cube.write_text("\n".join(line for line in [*lines[:9], "v 9 9 99", *lines[9:]] if not line.startswith("f 5")))
    facts = told(run, cube)
    assert (facts["closed"], facts["boundary_edges"], facts["unused_points"]) == (False, 4, 1)


def test_a_lattice(run, lattice):
    facts = told(run, lattice)
    deformer = pl.read_transform(lattice)
    assert facts["kind"] == "BSplineFFD"
    assert facts["variant"] == "A"
    assert facts["control_points"] == [4, 5, 6]
    assert np.allclose(facts["spacing"], deformer.spacing)
    assert np.allclose(facts["far_corner"], [10, 10, 10], atol=1e-5)
    assert facts["axes"] == ["+x", "+y", "+z"]
    assert (facts["hand"], facts["direction"], facts["edge"]) == ("right", "pull-back", "clamp")
    points = np.random.default_rng(0).uniform(0, 10, (500, 3))
    ratio = np.linalg.det(deformer.jacobian(points))
    assert facts["det_J"]["from"] - 0.1 < ratio.min() < ratio.max() < facts["det_J"]["to"] + 0.1
    assert facts["folds"].startswith("0 of")


def test_a_translation_neither_squeezes_nor_varies(run, tmp_path):
    path = tmp_path / "left.FFD"
    axes = np.array([[0, 1, 0], [1, 0, 0], [0, 0, 1.0]])  # left-handed
    offsets = np.broadcast_to([3.0, 4.0, 0.0], (3, 1, 4, 3))
    pl.write_transform(pl.BSplineFFD(displacements=offsets, origin=(1, 2, 3), spacing=(5, 6, 7), axes=axes), path)
    facts = told(run, path)
    assert np.allclose([facts["displacement"]["from"], facts["displacement"]["to"]], 5)
    assert np.allclose([facts["det_J"]["from"], facts["det_J"]["to"]], 1)
    assert np.allclose(facts["origin"], [1, 2, 3])


def test_an_oblique_left_handed_lattice(run, tmp_path):
    path = tmp_path / "left.FFD"
    turn = pl.Affine.rotation("z", np.radians(30)).linear * [1, 1, -1]
    pl.write_transform(pl.BSplineFFD.around(np.eye(3) * 50, shape=(3, 3, 3), axes=turn), path)
    facts = told(run, path)
    assert facts["hand"] == "left"
    assert facts["axes"][2] == "-z"
    assert facts["axes"][0] == "(0.8660 0.5000 0.0000)"


def test_a_guess_is_among_the_warnings(run, lattice):
    text = lattice.read_text().replace("4\n5\n6\n", "6\n5\n4\n").split("#quaternion")[0]
    lattice.write_text(text)
    facts = told(run, lattice)
    assert facts["variant"] == "B"
    assert any("does not say where" in warning for warning in facts["warnings"])
    assert told(run, lattice, "--variant", "A")["variant"] == "A"


def test_an_affine_map(run, tmp_path):
    path = tmp_path / "double.AFF"
    pl.write_transform(pl.Affine.scaling(2), path)
    facts = told(run, path)
    assert facts["matrix"] == np.diag([2.0, 2, 2, 1]).tolist()
    assert np.isclose(facts["det_J"], 8)
    assert facts["parameters"]["scaling"] == "1.000000 1.000000 1.000000"


def test_people_are_told_the_same(run, cube, lattice):
    assert "corners a face      4 6\n" in run("info", cube).stdout
    text = run("info", lattice).stdout
    assert "control points          4 5 6\n" in text
    assert "sampled at" in text


def test_converts_meshes(run, cube, tmp_path):
    ply, back = tmp_path / "cube.ply", tmp_path / "back.off"
    assert run("convert", cube, ply).exit_code == 0
    assert run("convert", ply, back).exit_code == 0
    assert (pl.read(back).points == pl.read(cube).points).all()
    assert (pl.read(back).faces.flat == pl.read(cube).faces.flat).all()


@pytest.mark.parametrize("ending", [".ffd", ".FFD"])
def test_converts_transforms(run, lattice, tmp_path, ending):
    copy = tmp_path / f"copy{ending}"
    result = run("convert", lattice, copy, "--json")
    assert result.exit_code == 0
    assert copy.read_bytes() == lattice.read_bytes()
    assert json.loads(result.stdout)["losses"] == []
