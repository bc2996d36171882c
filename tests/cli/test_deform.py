"""``pliant deform`` does what the library does, and nothing to what it was not asked to touch."""

from __future__ import annotations

import json
import time

import numpy as np
import pytest

import pliant as pl
from pliant.cli.session import Session


def test_applies_the_map_of_a_file(run, cube, lattice, tmp_path):
    out = tmp_path / "out.obj"
    assert run("deform", cube, "--ffd", lattice, "-o", out).exit_code == 0
    before, after = pl.read(cube), pl.read(out)
    assert np.allclose(after.points, pl.read_transform(lattice)(before.points), rtol=1e-15)
    other = [
        [line for line in path.read_text().splitlines() if line.startswith(("vt", "g", "o"))] for path in (cube, out)
    ]
    assert other[0] == other[1]
    for name in ("indices", "values"):
        assert (getattr(after.uvs, name) == getattr(before.uvs, name)).all()
    assert (after.faces.flat == before.faces.flat).all()


def test_the_inverse_undoes(run, cube, lattice, tmp_path):
    there, back = tmp_path / "there.obj", tmp_path / "back.obj"
    assert run("deform", cube, "--ffd", lattice, "-o", there).exit_code == 0
    assert run("deform", there, "--ffd", lattice, "--inverse", "-o", back).exit_code == 0
    assert np.allclose(pl.read(back).points, pl.read(cube).points, atol=1e-6)


def test_moves_control_points_of_a_new_lattice(run, cube, tmp_path):
    out = tmp_path / "out.obj"
    words = ("--lattice", "3x4x5", "--margin", "0.1", "--edge", "zero")
    result = run("deform", cube, *words, "--move", "2,3,4:1,2,3", "--move", "0,0,0:-1,0,0.5", "-o", out)
    assert result.exit_code == 0
    mesh = pl.read(cube)
    expected = pl.BSplineFFD.around(mesh, shape=(3, 4, 5), margin=0.1, edge="zero")
    controls = expected.rest.copy()
    controls[2, 3, 4] += (1, 2, 3)
    controls[0, 0, 0] += (-1, 0, 0.5)
    assert np.allclose(pl.read(out).points, expected.moved(controls)(mesh.points), atol=1e-12)


def test_moves_control_points_of_a_file_too(run, cube, lattice, tmp_path):
    out = tmp_path / "out.obj"
    assert run("deform", cube, "--ffd", lattice, "--move", "1,1,1:0,0,2", "-o", out).exit_code == 0
    deformer = pl.read_transform(lattice)
    controls = deformer.controls.copy()
    controls[1, 1, 1, 2] += 2
    assert np.allclose(pl.read(out).points, deformer.moved(controls)(pl.read(cube).points), atol=1e-12)


@pytest.mark.parametrize("inverse", [[], ["--inverse"]])
def test_an_lps_mesh_is_turned_before_and_after(run, cube, lattice, tmp_path, inverse):
    mesh = pl.read(cube)
    turned, out, expected = tmp_path / "lps.obj", tmp_path / "out.obj", tmp_path / "ras.obj"
    turn = pl.Affine.scaling([-1, -1, 1])
    pl.write(turn(mesh), turned)
    assert run("deform", turned, "--ffd", lattice, "--mesh-space", "LPS", *inverse, "-o", out).exit_code == 0
    assert run("deform", cube, "--ffd", lattice, "--mesh-space", "RAS", *inverse, "-o", expected).exit_code == 0
    there, here = pl.read(out), pl.read(expected)
    assert np.allclose(there.points * [-1, -1, 1], here.points, atol=1e-7)
    normals = [mesh.normals.per_corner[mesh.normals.indices >= 0] for mesh in (there, here)]
    assert np.allclose(normals[0] * [-1, -1, 1], normals[1], atol=1e-6)


def test_a_lattice_is_fitted_to_the_mesh(run, cube, lattice, tmp_path):
    far, out = tmp_path / "far.obj", tmp_path / "out.obj"
    mesh = pl.read(cube)
    pl.write(mesh.with_points(mesh.points * [2, 3, 4] + 100), far)
    assert run("deform", far, "--ffd", lattice, "--placement", "fit", "-o", out).exit_code == 0
    here = pl.read_transform(lattice)(mesh.points)
    assert np.allclose(pl.read(out).points, here * [2, 3, 4] + 100, atol=1e-5)


def test_variant_edge_and_origin_reach_the_reader(run, cube, lattice, tmp_path):
    bare, out = tmp_path / "bare.FFD", tmp_path / "out.obj"
    bare.write_text(lattice.read_text().split("#quaternion")[0])
    words = ("--variant", "D", "--edge", "zero", "--origin", "1,-2,3")
    assert run("deform", cube, "--ffd", bare, *words, "-o", out).exit_code == 0
    expected = pl.read_transform(bare, variant="D", edge="zero", origin=(1, -2, 3))
    assert np.allclose(pl.read(out).points, expected(pl.read(cube).points), atol=1e-12)


def test_the_result_in_json_is_all_there_is_on_stdout(run, cube, lattice, tmp_path):
    out = tmp_path / "out.stl"
    result = run("deform", cube, "--ffd", lattice, "-o", out, "--json", "--quiet")
    told = json.loads(result.stdout)
    moved = np.linalg.norm(pl.read_transform(lattice)(pl.read(cube).points) - pl.read(cube).points, axis=1)
    assert np.isclose(told["displacement"]["largest"], moved.max())
    assert np.isclose(told["displacement"]["mean"], moved.mean())
    assert told["points"] == 8
    assert told["output"] == str(out)
    assert any("texture" in loss.lower() or "uv" in loss.lower() for loss in told["losses"])
    assert len(told["warnings"]) == len(told["losses"])


def test_long_work_says_why(capsys):
    session = Session()
    with session.patience():
        time.sleep(1.3)
    with session.patience():
        pass
    assert capsys.readouterr().err.count("compiles") == 1


def test_quiet_leaves_warnings_only(run, cube, lattice, tmp_path):
    loud = run("deform", cube, "--ffd", lattice, "-o", tmp_path / "out.obj")
    assert "wrote" in loud.stderr
    assert loud.stdout == ""
    quiet = run("deform", cube, "--ffd", lattice, "-o", tmp_path / "out.obj", "-q")
    assert quiet.stderr == quiet.stdout == ""


@pytest.mark.parametrize(
    ("words", "cause"),
    [
        ([], "say how to deform"),
        (["--inverse"], "nothing to move or invert"),
        (["--lattice", "4x4"], "no lattice"),
        (["--lattice", "4x0x4"], "no lattice"),
        (["--lattice", "9999x9999x9999"], "control points"),
        (["--lattice", "4x4x4", "--move", "1,1:2,2,2"], "no move"),
        (["--lattice", "4x4x4", "--move", "1,1,1:2,2"], "three numbers"),
        (["--lattice", "4x4x4", "--move", "1,1,1:2,nan,2"], "not finite"),
        (["--lattice", "4x4x4", "--move", "1,4,1:2,2,2"], "4 x 4 x 4 control points"),
        (["--lattice", "4x4x4", "--margin", "-1"], "margin"),
        (["--lattice", "4x4x4", "--mesh-space", "LPS"], "own space"),
        (["--lattice", "4x4x4", "--edge", "wrap"], "wrap"),
        (["--ffd", "LATTICE", "--lattice", "4x4x4"], "not both"),
        (["--ffd", "LATTICE", "--origin", "1,2"], "three numbers"),
    ],
)
def test_wrong_usage_is_told_and_leaves_nothing(run, cube, lattice, tmp_path, words, cause):
    before = sorted(tmp_path.iterdir())
    result = run(
        "deform", cube, *(lattice if word == "LATTICE" else word for word in words), "-o", tmp_path / "out.obj"
    )
    assert result.exit_code == 2
    assert cause in " ".join(result.stderr.split())
    assert sorted(tmp_path.iterdir()) == before


def test_an_affine_map_has_no_control_points_to_move(run, cube, tmp_path):
    turn = tmp_path / "turn.AFF"
    pl.write_transform(pl.Affine.rotation("z", 1.0), turn)
    assert run("deform", cube, "--ffd", turn, "--move", "0,0,0:1,1,1", "-o", tmp_path / "out.obj").exit_code == 2
    assert run("deform", cube, "--ffd", turn, "-o", tmp_path / "out.obj").exit_code == 0
    expected = pl.Affine.rotation("z", 1.0)(pl.read(cube).points)
    assert np.allclose(pl.read(tmp_path / "out.obj").points, expected, atol=1e-4)
