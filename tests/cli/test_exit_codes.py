"""What the shell is told: exit codes, one clear line, and no file left behind."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest

import pliant as pl


def shell(*words, code=None):
    start = ["-m", "pliant"] if code is None else ["-c", code]
    return subprocess.run([sys.executable, *start, *map(str, words)], capture_output=True, text=True, check=False)


@pytest.fixture
def folded(tmp_path):
    """A lattice that turns the middle of the cube inside out."""
    path = tmp_path / "folded.FFD"
    deformer = pl.BSplineFFD.around(np.array([[0, 0, 0], [10, 10, 10.0]]), shape=(5, 5, 5))
    controls = deformer.rest.copy()
    controls[..., 0] = 10 - controls[..., 0]
    pl.write_transform(deformer.moved(controls), path)
    return path


def test_0_for_what_went_well(cube, lattice, tmp_path):
    done = shell("deform", cube, "--ffd", lattice, "-o", tmp_path / "out.obj", "--json")
    assert done.returncode == 0
    assert json.loads(done.stdout)["points"] == 8


def test_2_for_wrong_usage(cube):
    assert shell("deform", cube).returncode == 2
    assert shell("bend", cube).returncode == 2
    assert shell("info").returncode == 2


def test_3_for_files_that_cannot_be_read(run, cube, lattice, tmp_path):
    lattice.write_bytes(lattice.read_bytes()[:400])
    before = sorted(tmp_path.iterdir())
    broken = shell("deform", cube, "--ffd", lattice, "-o", tmp_path / "out.obj", "--json", "-q")
    assert broken.returncode == 3
    assert len(broken.stderr.splitlines()) == 1
    assert broken.stderr.startswith(f"error: {lattice}, line ")
    error = json.loads(broken.stdout)
    assert (error["kind"], error["exit_code"]) == ("UnreadableFile", 3)
    assert sorted(tmp_path.iterdir()) == before
    for words in (
        ("info", tmp_path / "none.obj"),
        ("info", tmp_path),
        ("convert", cube, tmp_path / "out.unknown"),
        ("convert", cube, cube / "out.obj"),
    ):
        result = run(*words)
        assert result.exit_code == 3, words
        assert len(result.stderr.splitlines()) == 1
        assert result.stderr.startswith("error: ")
    assert sorted(tmp_path.iterdir()) == before


def test_4_for_an_inverse_that_is_not_there(run, cube, folded, tmp_path):
    mesh = pl.read(cube)
    pl.write(mesh.with_points(mesh.points * 0.2 + 4), cube)
    result = run("deform", cube, "--ffd", folded, "--inverse", "-o", tmp_path / "out.obj")
    assert result.exit_code == 4
    assert "folds" in result.stderr
    assert not (tmp_path / "out.obj").exists()


def test_5_for_losses_that_were_refused(run, cube, lattice, tmp_path):
    result = run("deform", cube, "--ffd", lattice, "--strict", "-o", tmp_path / "out.stl")
    assert result.exit_code == 5
    assert "would lose" in result.stderr
    assert not (tmp_path / "out.stl").exists()


@pytest.mark.parametrize("debug", [[], ["--debug"]])
def test_1_for_bugs_with_a_traceback_on_request(debug):
    code = (
        "import sys; import pliant.io.files as files\n"
        "def broken(path): raise ZeroDivisionError('nobody thought of this')\n"
        "files.read_bytes = broken\n"
        "from pliant.cli.__main__ import main; main()"
    )
    result = shell(*debug, "info", "a.obj", code=code)
    assert result.returncode == 1
    assert "bug in pliant: ZeroDivisionError: nobody thought of this" in result.stderr
    assert "report" in result.stderr
    assert ("Traceback" in result.stderr) == bool(debug)


def test_help_imports_nothing_heavy():
    code = (
        "import sys\nfrom pliant.cli.__main__ import main\n"
        "try: main()\nexcept SystemExit: pass\n"
        "print([name for name in ('numpy', 'scipy', 'numba', 'rich', 'orjson') if name in sys.modules])"
    )
    told = shell("--help", code=code).stdout
    assert told.endswith("[]\n")
    for word in ("deform", "info", "check", "convert", "render", "demo", "Exit codes", "not converged"):
        assert word in told


def test_every_command_explains_itself(run):
    for command in ("deform", "info", "check", "convert", "render", "demo"):
        text = run(command, "--help").stdout
        assert text.startswith("Usage:")
        assert "--json" in text
    assert run("--version").stdout == f"pliant {pl.__version__}\n"
