"""Squash: volume is kept at every point, and lengths along the axis are the integral that they should be."""

from __future__ import annotations

import numpy as np
import pytest
from barr_cases import KEYS, POINTS, SKEW, bounds, directions, smooth, square, third, twice
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from pliant.errors import InvalidControls, InvalidDeformer
from pliant.field.volumes import volume
from pliant.mesh import PolygonMesh
from pliant.space.profile import Profile
from pliant.space.squash import Squash
from pliant.testing import check_deformer

PROFILES = ["bump", "constant", "ramp", KEYS, Profile(square, twice, third)]


@pytest.mark.parametrize("profile", PROFILES)
def test_obeys_the_laws_of_deformers(profile):
    squash = Squash.around(POINTS, factor=0.6, profile=profile, **SKEW)
    check_deformer(squash, POINTS, smooth=smooth(squash))


@settings(deadline=None, max_examples=30)
@given(directions, st.floats(0.4, 3), bounds, st.sampled_from(PROFILES))
def test_volume_is_kept_everywhere(axis, factor, limits, profile):
    squash = Squash(axis=axis, factor=factor, bounds=limits, profile=profile)
    assert np.abs(np.linalg.det(squash.jacobian(POINTS)) - 1).max() < 1e-12


@pytest.mark.parametrize("profile", PROFILES)
def test_the_axis_is_stretched_by_the_profile(profile):
    squash = Squash(factor=1.7, bounds=(-0.5, 0.7), profile=profile, origin=[0, 0, 0.1])
    curve = squash._curve

    def stretch(z):
        return float(1 + 0.7 * np.asarray(curve.value(np.clip(np.atleast_1d((z + 0.5) / 1.2), 0, 1)))[0])

    for z in (-1.5, -0.2, 0.1, 0.5, 2.0):
        kinks = [k for k in (-0.5, -0.38, -0.02, 0.46, 0.7) if min(0.1, z) < k < max(0.1, z)]
        expected = 0.1 + quad(stretch, 0.1, z, points=kinks or None, epsabs=1e-13)[0]
        moved = squash([[0.3, -0.4, z]])[0]
        assert moved[2] == pytest.approx(expected, abs=1e-12)
        assert moved[:2] == pytest.approx(np.array([0.3, -0.4]) / np.sqrt(stretch(z)))


def test_the_piece_between_the_bounds_gets_the_factors_length():
    squash = Squash(factor=0.5, bounds=(1.0, 3.0))
    ends = squash([[0, 0, 1.0], [0, 0, 3.0], [2.0, 5.0, 4.0]])
    assert ends[1, 2] - ends[0, 2] == pytest.approx(1.0)
    assert ends[2, :2].tolist() == [2.0, 5.0]  # beyond the bounds sections keep their size


def test_a_closed_mesh_keeps_its_volume():
    corners = np.array([[x, y, z] for x in (0, 2.0) for y in (0, 3.0) for z in (0, 1.0)])
    cube = PolygonMesh(corners, [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    for axis in ("x", [1, 2, 3]):
        squashed = Squash.around(cube, axis=axis, factor=0.5, profile="constant")(cube)
        assert volume(squashed) == pytest.approx(volume(cube), rel=1e-12)


def test_refusals_name_the_cause():
    with pytest.raises(InvalidDeformer, match=r"above 0\.333333"):
        Squash(factor=0.3)
    with pytest.raises(InvalidDeformer, match="below zero"):
        Squash(factor=3, profile=(-1, 1))
    with pytest.raises(InvalidDeformer, match="integral"):
        Squash(profile=Profile(square, twice))
    with pytest.raises(InvalidControls, match="folds"):
        Squash().moved([-1.0])
    assert np.isfinite(Squash(factor=0.1, profile="constant")(POINTS)).all()
