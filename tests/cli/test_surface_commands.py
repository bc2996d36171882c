"""``edit``, ``skeleton``, ``smooth`` and ``transfer`` do what the library does."""

from __future__ import annotations

import json

import numpy as np
import pytest

import pliant as pl
from pliant import examples


@pytest.fixture
def vase(tmp_path):
    path = tmp_path / "vase.ply"
    pl.write(pl.PolygonMesh((mesh := examples.vase(around=16, along=12)).points, mesh.faces), path)
    return path


@pytest.mark.parametrize(
    ("method", "kind"), [("arap", pl.ARAP), ("laplacian", pl.LaplacianEdit), ("skeleton", pl.SkeletonEdit)]
)
def test_edit_moves_the_handle_and_nothing_outside(run, vase, tmp_path, method, kind):
    out, mesh = tmp_path / "out.ply", pl.read(vase)
    words = ("--roi", "sphere:0,0,240:120", "--handle", "sphere:0,0,240:70", "--move", "10,0,-5")
    result = run("edit", vase, *words, "--method", method, "-o", out, "--json", "-q")
    assert result.exit_code == 0, result.stderr
    away = np.linalg.norm(mesh.points - [0, 0, 240], axis=1)
    roi, handle = np.flatnonzero(away <= 120), np.flatnonzero(away <= 70)
    expected = kind(roi, handle, goal=mesh.points[handle] + [10, 0, -5])(mesh)
    assert np.allclose(pl.read(out).points, expected.points, atol=1e-9)
    facts = json.loads(result.stdout)
    assert facts["moved"] == (expected.points != mesh.points).any(axis=1).sum()
    assert ("iterations" in facts) == (method == "arap")


@pytest.mark.parametrize("text", ["0-40", "@region.txt", "geodesic:0:60", "all"])
def test_regions_are_typed_in_several_ways(run, vase, tmp_path, monkeypatch, text):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "region.txt").write_text("\n".join(map(str, range(41))))
    result = run(
        "edit", vase, "--roi", text, "--handle", "0-3,5", "--move", "1,2,3", "--method", "laplacian", "-o", "o.ply"
    )
    assert result.exit_code == 0, result.stderr
    moved = pl.read("o.ply").points - pl.read(vase).points
    assert np.allclose(moved[[0, 1, 2, 3, 5]], [1, 2, 3])


@pytest.mark.parametrize(
    ("words", "code", "cause"),
    [
        (("--roi", "nowhere", "--handle", "0", "--move", "1,0,0"), 2, "is no region"),
        (("--roi", "sphere:0,0,0:x", "--handle", "0", "--move", "1,0,0"), 2, "not a radius"),
        (("--roi", "0-9", "--handle", "20", "--move", "1,0,0"), 3, "outside the region"),
        (("--roi", "0-999999", "--handle", "0", "--move", "1,0,0"), 3, "vertex 999999"),
        (("--roi", "0-9", "--handle", "0", "--move", "up"), 2, "three numbers"),
    ],
)
def test_edit_says_what_is_wrong(run, vase, tmp_path, words, code, cause):
    result = run("edit", vase, *words, "-o", tmp_path / "out.ply")
    assert (result.exit_code, cause in result.stderr) == (code, True), result.stderr
    assert not (tmp_path / "out.ply").exists()


def test_skeleton_writes_lines(run, vase, tmp_path):
    result = run("skeleton", vase, "-o", tmp_path / "skeleton.vtp", "--contours", 8, "--json", "-q")
    assert result.exit_code == 0, result.stderr
    lines = pl.read(tmp_path / "skeleton.vtp")
    assert (len(lines.points), len(lines.lines)) == tuple(json.loads(result.stdout)[k] for k in ("points", "links"))


def test_smooth_smooths(run, vase, tmp_path):
    result = run(
        "smooth", vase, "-o", tmp_path / "out.ply", "-n", 3, "--method", "taubin", "--roi", "sphere:0,0,240:90"
    )
    assert result.exit_code == 0, result.stderr
    mesh = pl.read(vase)
    within = np.flatnonzero(np.linalg.norm(mesh.points - [0, 0, 240], axis=1) <= 90)
    expected = pl.smooth(mesh, 3, method="taubin", within=within).points
    assert np.allclose(pl.read(tmp_path / "out.ply").points, expected, atol=1e-9)


def test_transfer_writes_a_mesh_a_pose_and_keeps_the_correspondence(run, vase, tmp_path):
    mesh = pl.read(vase)
    ids = np.arange(0, len(mesh.points), 9)
    markers, pairs, pose = tmp_path / "markers.txt", tmp_path / "pairs.txt", tmp_path / "pose.ply"
    markers.write_text(f"{len(ids)}\n" + "\n".join(f"{i}, {i}" for i in ids))
    pl.write(mesh.with_points(mesh.points * [1.0, 1.2, 0.9]), pose)
    for _ in range(2):
        result = run(
            "transfer", vase, pose, vase, "--markers", markers, "-o", tmp_path / "out", "--correspondence", pairs
        )
        assert result.exit_code == 0, result.stderr
        moved = pl.read(tmp_path / "out" / "vase-pose.ply").points
        expected = mesh.points * [1.0, 1.2, 0.9]
        assert np.abs(moved - moved.mean(axis=0) - expected + expected.mean(axis=0)).max() < 1e-3 * mesh.diagonal
    assert len(pl.read_pairs(pairs)) >= len(mesh.triangles)


@pytest.mark.parametrize(
    ("text", "cause"), [("3\n1, 2\n", "says 3 pairs"), ("1, two\n", "line 1"), ("1 2\n1, 2, 3\n", "line 2")]
)
def test_damaged_marker_files_are_named(run, vase, tmp_path, text, cause):
    (tmp_path / "markers.txt").write_text(text)
    result = run("transfer", vase, vase, vase, "--markers", tmp_path / "markers.txt", "-o", tmp_path / "out")
    assert result.exit_code == 3
    assert cause in result.stderr
