"""Recipes, projects and templates on the command line: what they make is what the library makes."""

from __future__ import annotations

import json

import numpy as np
import pytest

import pliant as pl

RECIPE = '[[layer]]\nname = "turn"\nkind = "twist"\naround = true\nangle = 90\n'
KEYS = '[[key]]\nlayer = "turn"\ntime = 0\nangle = 0\n[[key]]\nlayer = "turn"\ntime = 1\nangle = 90\n'


@pytest.fixture
def recipe(tmp_path):
    path = tmp_path / "turn.toml"
    path.write_text(RECIPE + KEYS)
    return path


@pytest.fixture
def project(cube, tmp_path):
    mesh = pl.read(cube)
    stack = pl.Stack([pl.Layer("turn", pl.Twist.around(mesh, angle=0.5)), pl.Layer("lift", pl.Scale(z=2.0))])
    clip = pl.Clip(mesh, stack, duration=1.0, fps=4).key("turn", 1.0, {"angle": 1.0})
    pl.save_project(pl.Scene(mesh, stack, clip), tmp_path / "scene.pliant")
    return tmp_path / "scene.pliant"


def test_apply_deforms_by_a_recipe(run, cube, recipe, tmp_path):
    done = run("apply", recipe, cube, "-o", tmp_path / "out.obj", "--intensity", "0.5", "--json")
    assert done.exit_code == 0, done.stderr
    mesh = pl.read(cube)
    expected = pl.Twist.around(mesh, angle=np.pi / 4)(mesh.points)
    assert np.allclose(pl.read(tmp_path / "out.obj").points, expected, atol=1e-12)
    largest = np.linalg.norm(expected - mesh.points, axis=1).max()
    assert np.isclose(json.loads(done.stdout)["displacement"]["largest"], largest)


def test_apply_takes_a_moment_of_a_motion_and_templates_and_y_up(run, cube, recipe, tmp_path):
    assert run("apply", recipe, cube, "-o", tmp_path / "a.obj", "--time", "0.5").exit_code == 0
    mesh = pl.read(cube)
    assert np.allclose(pl.read(tmp_path / "a.obj").points, pl.Twist.around(mesh, angle=np.pi / 4)(mesh.points))
    done = run("apply", "bulge", cube, "-o", tmp_path / "b.obj", "--time", "1.2", "--up", "y")
    assert done.exit_code == 0, done.stderr
    expected = pl.template("bulge").clip(mesh, up="y").sample(1.2).points
    assert np.allclose(pl.read(tmp_path / "b.obj").points, expected, atol=1e-9)


def test_apply_takes_a_project_for_another_mesh(run, cube, project, tmp_path):
    done = run("apply", project, cube, "-o", tmp_path / "out.obj")
    assert done.exit_code == 0, done.stderr
    assert np.allclose(pl.read(tmp_path / "out.obj").points, pl.load_project(project).deformed().points)


def test_export_recipe_writes_what_apply_reads(run, cube, project, tmp_path):
    done = run("export-recipe", project, "-o", tmp_path / "out.toml", "--title", "Mine", "--json")
    assert json.loads(done.stdout)["layers"] == ["turn", "lift"]
    assert pl.read_recipe(tmp_path / "out.toml").title == "Mine"
    assert run("apply", tmp_path / "out.toml", cube, "-o", tmp_path / "out.obj").exit_code == 0
    assert np.allclose(pl.read(tmp_path / "out.obj").points, pl.load_project(project).deformed().points)


def test_files_in_pieces_come_out_as_whole_ones_do(run, cube, recipe, tmp_path):
    pl.write(pl.read(cube).replace(carrier=None), tmp_path / "cube.ply")
    for command in (["apply", recipe, tmp_path / "cube.ply"], ["deform", tmp_path / "cube.ply", "--twist", "angle=90"]):
        assert run(*command, "-o", tmp_path / "whole.ply").exit_code == 0
        done = run(*command, "-o", tmp_path / "pieces.ply", "--stream", "--json")
        assert done.exit_code == 0, done.stderr
        assert json.loads(done.stdout)["points"] == len(pl.read(cube).points)
        whole, pieces = pl.read(tmp_path / "whole.ply"), pl.read(tmp_path / "pieces.ply")
        assert np.allclose(whole.points, pieces.points, atol=1e-12)
        assert np.array_equal(whole.faces.flat, pieces.faces.flat)
    done = run("apply", recipe, cube, "-o", tmp_path / "out.obj", "--stream")
    assert done.exit_code == 3
    assert "only binary PLY and STL" in done.stderr
    assert run("apply", recipe, tmp_path / "cube.ply", "-o", "o.ply", "--stream", "--time", "1").exit_code == 2


def test_recipes_that_are_exported_to_fit_do(run, cube, project, tmp_path):
    mesh = pl.read(cube)
    pl.write(mesh.with_points(10 * mesh.points + [1, 2, 3]), tmp_path / "large.obj")
    assert run("export-recipe", project, "-o", tmp_path / "fit.toml", "--fit").exit_code == 0
    assert run("apply", tmp_path / "fit.toml", tmp_path / "large.obj", "-o", tmp_path / "out.obj").exit_code == 0
    wanted = 10 * pl.load_project(project).deformed().points + [1, 2, 3]
    assert np.allclose(pl.read(tmp_path / "out.obj").points, wanted, atol=1e-9)


def test_animate_writes_a_motion(run, cube, recipe, project, tmp_path):
    done = run("animate", recipe, cube, "-o", tmp_path / "a.mdd", "--fps", "4", "--duration", "2", "--json")
    assert done.exit_code == 0, done.stderr
    assert json.loads(done.stdout)["frames"] == 9
    mesh = pl.read(cube)
    motion = pl.read_sequence(tmp_path / "a.mdd", mesh=mesh)
    assert np.abs(motion.at(1.0) - pl.Twist.around(mesh, angle=np.pi / 4)(mesh.points)).max() < 1e-5
    assert run("animate", project, cube, "-o", tmp_path / "b.glb", "--fps", "2").exit_code == 0
    assert len(pl.read_sequence(tmp_path / "b.glb")) == 3


def test_animate_exaggerates_a_motion(run, cube, tmp_path):
    mesh = pl.read(cube)
    still = pl.Stack([pl.Layer("up", pl.Affine())])
    path = pl.Clip(mesh, still, duration=1.0, fps=4).key("up", 0, {"matrix": np.eye(4)})
    path.key("up", 1.0, {"matrix": pl.Affine.translation([0, 0, 1]).matrix}).export(tmp_path / "up.pc2")
    (tmp_path / "none.toml").write_text('fps = 4\n[[layer]]\nname = "a"\nkind = "affine"\n')
    words = ("--motion", tmp_path / "up.pc2", "--amplify", "3")
    done = run("animate", tmp_path / "none.toml", cube, "-o", tmp_path / "far.pc2", *words)
    assert done.exit_code == 0, done.stderr
    motion = pl.read_sequence(tmp_path / "far.pc2", fps=4)
    assert np.abs(motion.at(1.0) - mesh.points - [0, 0, 3]).max() < 1e-5


def test_templates_lists_them(run):
    assert set(json.loads(run("templates", "--json").stdout)["templates"]) == set(pl.templates())
    assert "Bent to a bow." in run("templates").stdout


@pytest.mark.parametrize(
    ("words", "code", "cause"),
    [
        (["apply", "no-such", "MESH", "-o", "o.obj"], 2, "there is no template 'no-such'; there are: banana"),
        (["apply", "no.toml", "MESH", "-o", "o.obj"], 3, "No such file"),
        (["apply", "no.pliant", "MESH", "-o", "o.obj"], 3, "No such file"),
        (["apply", "PROJECT", "MESH", "-o", "o.obj", "--up", "y"], 2, "applied as it is"),
        (["animate", "RECIPE", "MESH", "-o", "o.fbx"], 3, "no format of animations"),
        (["animate", "RECIPE", "MESH", "-o", "o.glb", "--turns", "1"], 2, "is no film"),
        (["animate", "RECIPE", "MESH", "-o", "o.mp4", "--size", "big"], 2, "is no size, as in 960x720"),
        (["animate", "RECIPE", "MESH", "-o", "o.glb", "--fps", "0"], 2, "the clip is empty"),
        (["export-recipe", "MESH", "-o", "o.toml"], 3, "no sound zip archive"),
    ],
)
def test_what_cannot_be_done_is_told(run, cube, recipe, project, words, code, cause, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    known = {"MESH": cube, "RECIPE": recipe, "PROJECT": project}
    done = run(*[known.get(word, word) for word in words])
    assert done.exit_code == code, done.stderr
    assert cause in " ".join(done.stderr.split())
