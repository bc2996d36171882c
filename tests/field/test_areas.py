"""Areas agree with closed forms, their gradients with finite differences."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pliant as pl
from pliant import examples


def test_a_square_and_a_box_of_quadrangles():
    square = pl.PolygonMesh([[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0]], [[0, 1, 2, 3]])
    assert pl.area(square) == pytest.approx(6.0, rel=1e-15)
    assert pl.area(pl.PolygonMesh([[0, 0, 0]], [])) == 0.0


@settings(deadline=None, max_examples=20)
@given(seed=st.integers(0, 10_000))
def test_the_gradient_is_that_of_finite_differences(seed):
    rng = np.random.default_rng(seed)
    vase = examples.vase(around=7, along=5)
    vase = vase.with_points(vase.points + rng.normal(size=vase.points.shape))
    step = rng.normal(size=vase.points.shape)
    ahead, behind = (pl.area(vase.with_points(vase.points + h * step)) for h in (1e-5, -1e-5))
    terms = pl.area_gradient(vase) * step
    assert (ahead - behind) / 2e-5 == pytest.approx(terms.sum(), abs=1e-6 * np.abs(terms).sum())


def test_growing_by_scale_and_the_degenerate():
    vase = examples.vase(around=24, along=16)
    assert (pl.area_gradient(vase) * vase.points).sum() == pytest.approx(2 * pl.area(vase), rel=1e-12)  # Euler
    flat = pl.PolygonMesh([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]])
    assert pl.area(flat) == 0.0
    assert (pl.area_gradient(flat) == 0).all()
