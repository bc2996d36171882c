"""A command line in this process, and things to run it on."""

from __future__ import annotations

import numpy as np
import pytest
from typer.testing import CliRunner

import pliant as pl
from pliant.cli.app import app

CUBE = """\
o box
v 0 0 0
v 10 0 0
v 10 10 0
v 0 10 0
v 0 0 10
v 10 0 10
v 10 10 10
v 0 10 10
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vn 0 0 -1
vn 0 0 1
g floor
f 1/1/1 4/4/1 3/3/1 2/2/1
g lid
f 5/1/2 6/2/2 7/3/2 8/4/2
g sides
f 1/1 2/2 6/3 5/4
f 2/1 3/2 7/3 6/4
f 3/1 4/2 8/3 7/4
f 4/1 1/2 5/3 8/4
"""


@pytest.fixture
def run():
    """Run a command; the result has exit_code, stdout and stderr."""
    return lambda *words: CliRunner().invoke(app, [str(word) for word in words])


@pytest.fixture
def cube(tmp_path):
    path = tmp_path / "cube.obj"
    path.write_text(CUBE)
    return path


@pytest.fixture
def lattice(tmp_path):
    """A gentle .FFD around the cube, without a fold."""
    path = tmp_path / "gentle.FFD"
    rng = np.random.default_rng(0)
    deformer = pl.BSplineFFD.around(np.array([[0, 0, 0], [10, 10, 10.0]]), shape=(4, 5, 6))
    pl.write_transform(deformer.moved(deformer.rest + rng.uniform(-0.4, 0.4, deformer.rest.shape)), path)
    return path
