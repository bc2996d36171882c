"""Sites anywhere and lattices around an axis, from the command line as from the library."""

from __future__ import annotations

import numpy as np
import pytest

import pliant as pl


@pytest.fixture
def sites(tmp_path):
    """Two files of positions: at rest, and moved."""
    rest = np.array([[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 10], [10, 10, 10], [4, 5, 6.0]])
    moved = rest + np.random.default_rng(0).normal(size=rest.shape)
    for name, positions in (("sites", rest), ("moved", moved)):
        np.savetxt(tmp_path / f"{name}.csv", positions, delimiter=",", fmt="%.17g")
    return tmp_path / "sites.csv", tmp_path / "moved.csv", rest, moved


def test_sites_go_where_a_file_says_and_where_they_are_moved(run, cube, sites, tmp_path):
    before, after, rest, moved = sites
    out, mesh = tmp_path / "out.obj", pl.read(cube)
    deformer = pl.DirichletFFD(rest, smooth=True)
    assert run("deform", cube, "--dirichlet", before, "--sites-to", after, "-o", out).exit_code == 0
    assert np.allclose(pl.read(out).points, deformer.moved(moved)(mesh.points), atol=1e-12)
    assert run("deform", cube, "--dirichlet", before, "--move", "5:0,0,2.5", "-o", out).exit_code == 0
    controls = rest.copy()
    controls[5, 2] += 2.5
    assert np.allclose(pl.read(out).points, deformer.moved(controls)(mesh.points), atol=1e-12)


@pytest.mark.parametrize(
    ("words", "make"),
    [
        (("--cylinder", "8x4x7"), lambda mesh: pl.ExtendedFFD.cylinder(mesh, shape=(8, 4, 7), margin=0.1)),
        (("--prism", "5"), lambda mesh: pl.ExtendedFFD.prism(mesh, sides=5, margin=0.1)),
        (("--sphere", "8x4x7"), lambda mesh: pl.ExtendedFFD.sphere(mesh, margin=0.1)),
    ],
)
def test_lattices_around_an_axis(run, cube, tmp_path, words, make):
    out, mesh = tmp_path / "out.obj", pl.read(cube)
    assert run("deform", cube, *words, "--margin", "0.1", "--move", "20:1,2,3", "-o", out).exit_code == 0
    lattice = make(mesh)
    controls = lattice.rest.copy()
    controls[20] += (1, 2, 3)
    expected = lattice.moved(controls)(mesh.points)
    assert np.abs(expected - mesh.points).max() > 1e-3
    assert np.allclose(pl.read(out).points, expected, atol=1e-12)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--cylinder", "8x4x4", "--prism", "6"), "give one of --cylinder and --prism"),
        (("--cylinder", "8x4x4", "--lattice", "4x4x4"), "give one of --lattice and --cylinder"),
        (("--prism", "6", "--sites-to", "moved.csv"), "there are no sites to move"),
        (("--prism", "6", "--move", "9999:0,0,1"), "control points"),
        (("--prism", "6", "--move", "1,2,3:0,0,1"), "is no move"),
        (("--cylinder", "8x5x4"), "4, 7, 10"),
    ],
)
def test_what_cannot_be_is_said(run, cube, tmp_path, words, message):
    result = run("deform", cube, *words, "-o", tmp_path / "out.obj")
    assert result.exit_code != 0
    assert message in " ".join((result.stderr + result.stdout).replace("│", " ").split())
