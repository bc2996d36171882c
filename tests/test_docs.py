"""The tutorial does what it says: its code runs as it stands, in the order in which it stands."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import pliant as pl
from pliant import examples
from pliant.cli.app import app

DOCS = Path(__file__).parents[1] / "docs"


def blocks(page: str, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), flags=re.S)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with a mesh, where pictures are drawn fast."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("pliant.rendering.pictures.FINER", 1)
    pl.write(examples.vase(around=24, along=16), "shape.obj")
    return tmp_path


def test_the_tutorial_bends_the_shape_and_writes_what_it_bent(folder):
    names: dict = {}
    for code in blocks("tutorial.md", "python"):
        exec(compile(code, "tutorial.md", "exec"), names)
    rest, bent = pl.read("shape.obj"), pl.read("bent.obj")
    np.testing.assert_allclose(bent.points, names["points"], atol=1e-12 * rest.diagonal)
    np.testing.assert_array_equal(bent.faces.flat, rest.faces.flat)
    np.testing.assert_allclose(names["drag"].points, names["points"], atol=1e-12 * rest.diagonal)
    np.testing.assert_allclose(names["again"](rest.points), bent.points, atol=1e-6 * rest.diagonal)
    assert {"bent.png", "field.png", "ratio.png", "bent.FFD"} <= {path.name for path in folder.iterdir()}

    for path in ("bent.obj", "bent.png"):
        (folder / path).unlink()
    for line in blocks("tutorial.md", "bash")[0].splitlines():
        done = CliRunner().invoke(app, shlex.split(line)[1:])
        assert done.exit_code == 0, done.output
    np.testing.assert_allclose(pl.read("bent.obj").points, bent.points, atol=1e-6 * rest.diagonal)
    assert (folder / "bent.png").exists()


def test_the_first_page_moves_a_control_point(folder):
    names: dict = {}
    exec(compile(blocks("index.md", "python")[0], "index.md", "exec"), names)
    moved = np.linalg.norm(pl.read("bent.obj").points - names["mesh"].points, axis=1)
    assert 0 < moved.max() < 0.2 * names["mesh"].diagonal  # a control point attracts, and does not reach
