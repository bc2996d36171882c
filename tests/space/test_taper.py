"""Taper: against plain NumPy, Barr's normals with the r and r squared that a slide leaves out, and the inverse."""

from __future__ import annotations

import numpy as np
import pytest
from barr_cases import KEYS, POINTS, SKEW, bounds, carried, directions, smooth, square, twice
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import NotConverged
from pliant.numerics.maps.normals import carry_normals
from pliant.space.profile import Profile
from pliant.space.taper import Taper
from pliant.testing import check_deformer


@pytest.mark.parametrize("profile", ["ramp", "smooth", "bump", KEYS, Profile(square, twice)])
def test_obeys_the_laws_of_deformers(profile):
    taper = Taper.around(POINTS, factor=0.6, profile=profile, **SKEW)
    check_deformer(taper, POINTS, smooth=smooth(taper))


@settings(deadline=None, max_examples=30)
@given(st.floats(-2, 3), bounds)
def test_is_the_formula(factor, limits):
    taper = Taper(factor=factor, bounds=limits, origin=[1, 2, 3])
    t = np.clip((POINTS[:, 2] - limits[0]) / (limits[1] - limits[0]), 0, 1)
    r = 1 + (factor - 1) * t
    expected = np.column_stack([(POINTS[:, :2] - [1, 2]) * r[:, None] + [1, 2], POINTS[:, 2]])
    assert np.allclose(taper(POINTS), expected, atol=1e-13)
    assert np.allclose(np.linalg.det(taper.jacobian(POINTS)), r**2, atol=1e-13)


@settings(deadline=None, max_examples=20)
@given(directions, st.floats(0.1, 3), bounds)
def test_the_inverse_is_exact(axis, factor, limits):
    taper = Taper(factor=factor, bounds=limits, axis=axis)
    assert np.abs(taper.inverse(taper(POINTS)) - POINTS).max() < 1e-13


def test_normals_are_barrs():
    taper = Taper(factor=0.5, bounds=(-5.0, 5.0))
    normals = np.random.default_rng(1).normal(size=POINTS.shape)
    (x, y, z), (nx, ny, nz) = POINTS.T, normals.T
    slope = -0.05
    r = 1 + slope * (z + 5)
    expected = np.stack([r * nx, r * ny, -r * slope * (x * nx + y * ny) + r**2 * nz], axis=1)
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    assert np.allclose(carry_normals(taper.jacobian(POINTS), normals), expected, atol=1e-14)
    assert np.allclose(carried(taper, POINTS, normals), expected, atol=1e-8)


def test_a_cone_with_its_tip_has_no_inverse_there():
    tip = Taper(factor=0.0)
    with pytest.raises(NotConverged, match="shrinks"):
        tip.inverse([[0.0, 0.0, 2.0]])
    assert np.allclose(tip([[3.0, 4.0, 1.0]]), [[0, 0, 1]])
