"""Volume kept by a correction of the controls: exactly, for every linear deformer."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pliant as pl
from pliant.errors import InvalidDeformer, InvalidMesh, InvalidParameter

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
CUBE = pl.PolygonMesh(CORNERS, QUADS)


def ball(rings=10, around=14):
    """A sphere of quadrangles with two polygons at its poles."""
    t, p = np.linspace(0.2, np.pi - 0.2, rings), np.linspace(0, 2 * np.pi, around, endpoint=False)
    points = np.stack(
        [np.outer(np.sin(t), np.cos(p)), np.outer(np.sin(t), np.sin(p)), np.outer(np.cos(t), np.ones(around))], axis=-1
    ).reshape(-1, 3)
    row = np.arange(around)
    quads = [
        [r * around + i, (r + 1) * around + i, (r + 1) * around + (i + 1) % around, r * around + (i + 1) % around]
        for r in range(rings - 1)
        for i in row
    ]
    return pl.PolygonMesh(points, [*quads, row, (rings - 1) * around + row[::-1]])


def bent(seed, **fields):
    lattice = pl.BSplineFFD.around(ball(), **fields)
    return lattice.moved(lattice.rest + 0.1 * np.random.default_rng(seed).normal(size=lattice.rest.shape))


@given(seed=st.integers(0, 10_000), shape=st.sampled_from([(3, 3, 3), (5, 4, 6)]))
@settings(deadline=None, max_examples=10)
def test_the_volume_of_quadrangles_is_kept(seed, shape):
    mesh, deformer = ball(), bent(seed, shape=shape)
    kept = pl.preserve_volume(deformer, mesh)
    assert pl.volume(kept(mesh)) == pytest.approx(pl.volume(mesh), rel=1e-12)
    assert type(kept) is type(deformer)
    change = np.abs(kept.controls - deformer.controls).max()
    assert change <= 3 * abs(pl.volume(deformer(mesh)) - pl.volume(mesh))  # a correction, no other deformation


@pytest.mark.parametrize(
    "deformer",
    [
        pl.BezierFFD.around(ball(), shape=(3, 4, 3)),
        pl.BezierFFD.around(ball(), patches=(1, 2, 1), outside="extend"),
        pl.place(pl.BSplineFFD.around(ball()), pl.Affine.rotation([1, 2, 3], 0.7)),
        pl.DirichletFFD(ball().points[::9] * 1.2),
    ],
    ids=["hyperpatch", "patches", "placed", "Dirichlet"],
)
def test_any_linear_deformer_with_positions(deformer):
    mesh = ball()
    swollen = deformer.moved(deformer.rest * [1.2, 1.1, 1.0])
    kept = pl.preserve_volume(swollen, mesh)
    assert pl.volume(swollen(mesh)) > 1.05 * pl.volume(mesh)
    assert pl.volume(kept(mesh)) == pytest.approx(pl.volume(mesh), rel=1e-10)


def test_only_free_controls_move():
    mesh, deformer = ball(), bent(1, shape=(5, 5, 5))
    free = np.zeros((5, 5, 5), bool)
    free[2:, 1:4, 1:4] = True
    kept = pl.preserve_volume(deformer, mesh, free)
    assert np.allclose(kept.controls[~free], deformer.controls[~free], rtol=0, atol=1e-14)
    assert pl.volume(kept(mesh)) == pytest.approx(pl.volume(mesh), rel=1e-12)


def test_a_rest_that_keeps_volume_stays():
    lattice = pl.BSplineFFD.around(CUBE)
    assert np.allclose(pl.preserve_volume(lattice, CUBE).controls, lattice.rest, atol=1e-14)


@given(seed=st.integers(0, 10_000))
@settings(deadline=None, max_examples=10)
def test_the_gradient_is_exact_along_each_axis(seed):
    rng = np.random.default_rng(seed)
    mesh = ball()
    mesh = mesh.with_points(mesh.points + 0.05 * rng.normal(size=mesh.points.shape))
    gradient = pl.volume_gradient(mesh)
    for axis in range(3):
        step = np.zeros_like(mesh.points)
        step[:, axis] = rng.normal(size=len(step))
        change = pl.volume(mesh.with_points(mesh.points + step)) - pl.volume(mesh)
        assert change == pytest.approx((gradient * step).sum(), rel=1e-9, abs=1e-11)
    assert np.allclose(gradient.sum(axis=0), 0, atol=1e-12)  # a translation changes nothing
    assert (gradient * mesh.points).sum() == pytest.approx(3 * pl.volume(mesh))  # Euler: volume is of degree three


def test_a_correction_that_folds_is_told():
    mesh = ball()
    lattice = pl.BSplineFFD.around(mesh, shape=(4, 4, 4), margin=0.3)
    free = np.zeros((4, 4, 4), bool)
    free[1, 1, 1] = True
    with pytest.warns(pl.PliantWarning, match="the corrected deformation folds"):
        pl.preserve_volume(lattice.moved(lattice.rest * 1.3), mesh, free)


def test_bad_input():
    with pytest.raises(InvalidDeformer, match="no positions"):
        pl.preserve_volume(pl.Twist(axis="z", angle=1.0), CUBE)
    lattice = pl.BSplineFFD.around(CUBE)
    with pytest.raises(InvalidParameter, match=r"mask of shape \(4, 4, 4\)"):
        pl.preserve_volume(lattice, CUBE, np.ones((4, 4), bool))
    with pytest.raises(InvalidParameter, match="no free control"):
        pl.preserve_volume(lattice.moved(lattice.rest * 1.1), CUBE, np.zeros((4, 4, 4), bool))
    with pytest.raises(InvalidMesh, match="open"):
        pl.preserve_volume(lattice, pl.PolygonMesh(CORNERS, QUADS[1:]))
