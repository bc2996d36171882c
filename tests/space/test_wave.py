"""Wave: against plain NumPy, smooth on the axis without a phase, and with its exact inverse."""

from __future__ import annotations

import numpy as np
import pytest
from barr_cases import KEYS, POINTS, SKEW, smooth, square, twice
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import InvalidDeformer
from pliant.space.profile import Profile
from pliant.space.wave import Wave
from pliant.testing import check_deformer


@pytest.mark.parametrize("profile", ["constant", "bump", KEYS, Profile(square, twice)])
def test_obeys_the_laws_of_deformers(profile):
    wave = Wave.around(POINTS, amplitude=0.1, waves=1.5, phase=0.4, profile=profile, **SKEW)
    check_deformer(wave, POINTS, smooth=smooth(wave))


@settings(deadline=None, max_examples=30)
@given(st.floats(-1, 1), st.floats(-3, 3), st.floats(-7, 7), st.floats(0, 1), st.floats(0.1, 2))
def test_is_the_formula(amplitude, waves, phase, low, width):
    wave = Wave(amplitude=amplitude, waves=waves, phase=phase, bounds=(low, low + width), origin=[0.1, 0.2, 5])
    t = np.clip((np.hypot(POINTS[:, 0] - 0.1, POINTS[:, 1] - 0.2) - low) / width, 0, 1)
    shift = amplitude * np.cos(2 * np.pi * waves * t - phase)
    assert np.allclose(wave(POINTS), POINTS + np.outer(shift, [0, 0, 1]), atol=1e-13)
    assert np.allclose(np.linalg.det(wave.jacobian(POINTS)), 1, atol=1e-12)
    assert np.allclose(wave.inverse(wave(POINTS)), POINTS, atol=1e-13)


def test_on_the_axis_it_is_level():
    wave = Wave(amplitude=0.5, waves=2.0)
    axis = np.array([[0, 0, 0.0], [0, 0, 1.0]])
    assert (wave.jacobian(axis) == np.eye(3)).all()
    near = wave.jacobian(axis + [1e-7, 0, 0])
    assert np.abs(near - np.eye(3)).max() < 1e-4


def test_it_runs_from_the_axis_to_the_farthest_point():
    wave = Wave.around(POINTS, axis="z")
    middle = (POINTS.min(axis=0) + POINTS.max(axis=0)) / 2
    assert wave.bounds == pytest.approx((0, np.linalg.norm((POINTS - middle)[:, :2], axis=1).max()))
    with pytest.raises(InvalidDeformer, match="negative"):
        Wave(bounds=(-1, 2))
