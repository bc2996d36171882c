"""Inverses with an answer for each point, and the kernel for lattices against the general solver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pliant as pl
from pliant.errors import NotConverged
from pliant.numerics.maps.newton import solve

BOX = np.array([[0.0, 0, 0], [2.0, 3.0, 1.0]])
POINTS = np.random.default_rng(3).uniform(BOX[0] - 0.3, BOX[1] + 0.3, (3000, 3))


def shaken(rest, strength, seed=0):
    steps = (BOX[1] - BOX[0]) / np.maximum(np.array(rest.shape) - 1, 1)
    return rest.moved(rest.rest + strength * steps * np.random.default_rng(seed).normal(size=rest.rest.shape))


LATTICES = {
    "clamp": shaken(pl.BSplineFFD.around(BOX, shape=(5, 6, 4)), 0.15),
    "zero": shaken(pl.BSplineFFD.around(BOX, shape=(4, 4, 4), edge="zero"), 0.15),
    "affine": replace(
        shaken(pl.BSplineFFD.around(BOX, shape=(4, 4, 4)), 0.1),
        affine=pl.Affine.rotation([1, 1, 0], 2.5).matrix @ np.diag([2, 1, 1, 1.0]),
    ),
    "planar": shaken(pl.BSplineFFD.around(BOX, shape=(5, 5, 1)), 0.1),
    "patch": shaken(pl.BezierFFD.around(BOX, outside="extend"), 0.05),
    "patches": shaken(pl.BezierFFD.around(BOX, patches=(2, 2, 1), outside="extend"), 0.05),
    "degree 4": shaken(pl.BezierFFD.around(BOX, shape=(5, 4, 4), outside="extend"), 0.05),
}


@pytest.mark.parametrize("name", LATTICES)
def test_lattices_are_undone(name):
    deformer = LATTICES[name]
    found = pl.invert(deformer, deformer(POINTS), tolerance=1e-12)
    assert found.converged.all()
    assert not found.folded.any()
    assert len(found.failed) == 0
    assert np.abs(found.points - POINTS).max() < 1e-10
    assert found.residual.max() <= 1e-11


@given(seed=st.integers(0, 10_000), name=st.sampled_from(["clamp", "zero", "patches"]))
@settings(deadline=None, max_examples=10)
def test_the_kernel_agrees_with_the_general_solver(seed, name):
    deformer = shaken(LATTICES[name], 0.02, seed)
    images = deformer(POINTS[:300])
    general = solve(deformer._deformed, deformer.jacobian, images, tolerance=1e-12, iterations=50)
    fused = deformer._solved(images, 1e-12, 50)
    assert (fused.converged == general.converged).all()
    assert (fused.folded == general.folded).all()
    assert np.abs(fused.points - general.points)[~general.folded].max() < 1e-9


@given(seed=st.integers(0, 10_000), name=st.sampled_from(["clamp", "zero", "patches"]))
@settings(deadline=None, max_examples=10)
def test_the_kernel_fails_nowhere_else(seed, name):
    """Where a map folds the two may find different pre-images, but whatever one finds the other has."""
    deformer = shaken(LATTICES[name], 0.3, seed)
    images = deformer(POINTS[:300])
    general = solve(deformer._deformed, deformer.jacobian, images, tolerance=1e-12, iterations=50)
    fused = deformer._solved(images, 1e-12, 50)
    assert (fused.converged | ~general.converged).all()
    assert np.abs(deformer(fused.points) - images)[fused.converged].max() < 1e-9


def test_the_determinant_tells_folds_of_accepted_points():
    folding = shaken(pl.BSplineFFD.around(BOX, shape=(5, 5, 5)), 1.2, seed=2)
    found = pl.invert(folding, folding(POINTS))
    ratio = pl.volume_ratio(folding, found.points)
    clear = found.converged & (np.abs(ratio) > 1e-6)
    assert found.folded[clear].any()
    assert ((ratio <= 0) == found.folded)[clear].all()
    assert np.allclose(np.linalg.norm(folding(found.points) - folding(POINTS), axis=1), found.residual, atol=1e-12)


def test_points_without_a_pre_image_are_named_and_the_others_found():
    shrinking = pl.Scale(x=1.0, y=1.0, z=1.0)
    assert pl.invert(shrinking, POINTS).converged.all()
    flat = pl.BezierFFD.around(BOX)
    collapsed = flat.moved(flat.rest * [1, 1, 0] + [0, 0, 0.5])
    images = np.array([[1.0, 1.0, 0.25], [1.0, 1.0, 7.0]])  # in the emptied box; outside, where nothing moves
    found = pl.invert(collapsed, images)
    assert found.failed.tolist() == [0]
    assert found.residual[1] == 0
    assert np.allclose(found.points[1], images[1])
    with pytest.raises(NotConverged, match="1 of 2 points"):
        collapsed.inverse(images)


def test_no_points_and_analytic_inverses():
    assert pl.invert(LATTICES["clamp"], np.empty((0, 3))).points.shape == (0, 3)
    twist = pl.Twist(axis="z", angle=2.0)
    found = pl.invert(twist, twist(POINTS))
    assert np.abs(found.points - POINTS).max() < 1e-13


def test_results_are_read_only():
    with pytest.raises(ValueError, match="read-only"):
        pl.invert(LATTICES["patch"], POINTS[:2]).points[0] = 0
