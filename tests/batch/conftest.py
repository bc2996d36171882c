"""A cohort of small meshes, and a stack for them."""

import numpy as np
import pytest

import pliant as pl
from pliant.examples import vase


@pytest.fixture
def cohort(tmp_path):
    """Twelve vases of different heights."""
    paths = []
    for i in range(12):
        path = tmp_path / "cohort" / f"vase{i:02d}.ply"
        path.parent.mkdir(exist_ok=True)
        pl.write(vase(200.0 + 3 * i, 16, 12), path)
        paths.append(path)
    return paths


@pytest.fixture
def stack():
    """A twist, half a bend, and a lattice."""
    shape = vase(240.0, 16, 12)
    ffd = pl.BSplineFFD.around(shape, shape=(4, 4, 4))
    controls = ffd.rest + np.random.default_rng(3).normal(size=ffd.rest.shape)
    return pl.Stack(
        [
            pl.Layer("twist", pl.Twist.around(shape, axis="z", angle=1.0)),
            pl.Layer("bend", pl.Bend.around(shape, axis="y", angle=0.5, normal="z"), envelope=0.5),
            pl.Layer("lattice", ffd.moved(controls)),
        ]
    )


@pytest.fixture
def serial(stack, cohort, tmp_path):
    """The bytes of each output by index, as this process alone writes them."""
    outcomes = list(pl.run_batch(stack, cohort, tmp_path / "serial" / "{stem}.ply", workers=0))
    return {each.index: each.output.read_bytes() for each in outcomes}
