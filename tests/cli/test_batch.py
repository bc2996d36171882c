"""``pliant batch``: patterns in, patterns out, failures that stop nothing."""

from __future__ import annotations

import json

import numpy as np
import pytest
from distributed import LocalCluster

import pliant as pl
from pliant.examples import vase


@pytest.fixture
def cohort(tmp_path):
    for i in range(4):
        pl.write(vase(200.0 + i, 12, 8), tmp_path / f"vase{i}.ply")
    (tmp_path / "r.toml").write_text('[[layer]]\nname = "t"\nkind = "twist"\naround = true\naxis = "z"\nangle = 40\n')
    return tmp_path


def test_a_pattern_of_files(run, cohort):
    words = ("batch", cohort / "vase?.ply", "--recipe", cohort / "r.toml", "-o", f"{cohort}/out/{{stem}}.obj")
    result = run(*words, "--workers", 0, "--json")
    assert result.exit_code == 0, result.stderr
    told = json.loads(result.stdout)
    assert (told["done"], told["failed"]) == (4, 0)
    recipe = pl.read_recipe(cohort / "r.toml")
    for i in range(4):
        mesh = pl.read(cohort / f"vase{i}.ply")
        assert np.allclose(pl.read(cohort / "out" / f"vase{i}.obj").points, recipe.stack(mesh)(mesh).points)
    again = run(*words, "--workers", 0, "--resume")
    assert again.stderr.count("done before") == 4


def test_a_project_for_other_meshes(run, cohort):
    mesh = pl.read(cohort / "vase0.ply")
    stack = pl.Stack([pl.Layer("twist", pl.Twist.around(mesh, axis="z", angle=0.5))])
    pl.save_project(pl.Scene(mesh, stack), cohort / "twisted.pliant")
    words = ("batch", cohort / "vase?.ply", "-r", cohort / "twisted.pliant", "-o", f"{cohort}/out/{{stem}}.ply")
    assert run(*words, "--workers", 0).exit_code == 0
    other = pl.read(cohort / "vase3.ply")
    assert np.allclose(pl.read(cohort / "out" / "vase3.ply").points, stack(other).points, atol=1e-4)


def test_failures_stop_nothing(run, cohort):
    (cohort / "vase2.ply").write_text("ply\nbroken")
    result = run("batch", cohort / "vase*.ply", "-r", "twist-up", "-o", f"{cohort}/out/{{stem}}.ply", "--workers", 0)
    assert result.exit_code == 3
    assert "vase2.ply" in result.stderr
    assert sorted(path.stem for path in (cohort / "out").glob("*.ply")) == ["vase0", "vase1", "vase3"]
    assert result.stdout.split() == ["done", "3", "failed", "1"]


@pytest.mark.parametrize(
    ("words", "cause"),
    [
        (("{}/none*.ply", "-r", "twist-up", "-o", "{}/o/{{stem}}.ply"), "no file is called"),
        (("{}/vase*.ply", "-r", "twist-up", "-o", "{}/o/one.ply"), "would both be written"),
        (("{}/vase*.ply", "-r", "nonsense", "-o", "{}/o/{{stem}}.ply"), "no template 'nonsense'"),
        (("{}/vase0.ply", "-r", "twist-up", "-o", "{}/o/{{stem}}.ply", "--scheduler", "x", "--workers", "1"), "leave"),
        (("{}/vase0.ply", "-r", "twist-up", "-o", "{}/o/{{stem}}.ply", "--scheduler", "nonsense://x"), "scheduler"),
    ],
)
def test_wrong_usage(run, cohort, words, cause):
    result = run("batch", *(word.format(cohort) for word in words))
    assert result.exit_code == 2
    assert cause in " ".join(result.stderr.split())
    assert not (cohort / "o").exists()


@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_cluster(run, cohort):
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None) as cluster:
        words = ("-r", "twist-up", "-o", f"{cohort}/out/{{stem}}.ply", "--scheduler", cluster.scheduler_address)
        result = run("batch", cohort / "vase*.ply", *words)
    assert result.exit_code == 0, result.stderr
    assert len(list((cohort / "out").glob("*.ply"))) == 4
