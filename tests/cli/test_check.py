"""``pliant check``: gates against folds and lost volume."""

from __future__ import annotations

import json

import numpy as np
import pytest

import pliant as pl


@pytest.fixture
def folding(tmp_path):
    """A lattice that folds near its middle."""
    path = tmp_path / "folding.FFD"
    deformer = pl.BSplineFFD.around(np.array([[0, 0, 0], [10, 10, 10.0]]), shape=(5, 5, 5))
    moved = deformer.rest.copy()
    moved[2, 2, 2, 0] -= 9
    pl.write_transform(deformer.moved(moved), path)
    return path


def test_a_gentle_lattice_passes(run, lattice):
    result = run("check", lattice, "--json")
    assert result.exit_code == 0
    facts = json.loads(result.stdout)
    proof = pl.certify(pl.read_transform(lattice))
    assert (facts["status"], facts["injective"], facts["failures"]) == ("fold-free", True, [])
    assert facts["det_J_bounds"] == [proof.lower, proof.upper]
    assert facts["det_J_found"] == [proof.least, proof.greatest]


def test_a_fold_fails_and_its_place_is_told(run, folding):
    result = run("check", folding, "--json")
    assert result.exit_code == 5
    facts = json.loads(result.stdout)
    assert facts["status"] == "folds"
    assert "the map folds" in facts["failures"][0]
    assert pl.volume_ratio(pl.read_transform(folding), np.array([facts["least_at"]]))[0] < 0
    assert run("check", folding, "--min-det", "-5").exit_code == 0


def test_a_gate_between_bound_and_zero(run, lattice):
    proof = pl.certify(pl.read_transform(lattice))
    assert run("check", lattice, "--min-det", proof.lower - 1e-6).exit_code == 0
    result = run("check", lattice, "--min-det", (proof.lower + proof.least) / 2)
    assert result.exit_code == 5
    assert "only proved to be above" in result.stderr


def test_volume_of_a_mesh(run, lattice, cube, tmp_path):
    facts = json.loads(run("check", lattice, "--mesh", cube, "--json").stdout)
    mesh, deformer = pl.read(cube), pl.read_transform(lattice)
    change = pl.volume(deformer(mesh)) / pl.volume(mesh) - 1
    assert facts["volume_change"] == pytest.approx(change)
    gate = abs(change)
    assert run("check", lattice, "--mesh", cube, "--max-volume-change", 1.01 * gate).exit_code == 0
    result = run("check", lattice, "--mesh", cube, "--max-volume-change", 0.99 * gate)
    assert result.exit_code == 5
    assert "the volume changes by" in result.stderr


def test_a_mesh_in_the_other_axes(run, lattice, cube, tmp_path):
    turned = tmp_path / "turned.obj"
    pl.write(pl.Affine.scaling((-1, -1, 1))(pl.read(cube)), turned)
    here = json.loads(run("check", lattice, "--mesh", cube, "--json").stdout)["volume_change"]
    there = json.loads(run("check", lattice, "--mesh", turned, "--mesh-space", "LPS", "--json").stdout)["volume_change"]
    assert there == pytest.approx(here, abs=1e-9)


def test_affine_maps_are_exact(run, tmp_path):
    path = tmp_path / "double.AFF"
    pl.write_transform(pl.Affine.scaling(2), path)
    result = run("check", path)
    assert result.exit_code == 0
    assert "exact" in result.stdout


def test_wrong_usage(run, lattice, cube, tmp_path):
    assert run("check", lattice, "--max-volume-change", 0.1).exit_code == 2
    assert run("check", tmp_path / "none.FFD").exit_code == 3
    assert run("check", cube).exit_code == 3
