"""Sine: against plain NumPy; sheared sections keep their volume."""

from __future__ import annotations

import numpy as np
import pytest
from barr_cases import KEYS, POINTS, SKEW, bounds, smooth, square, twice
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import InvalidDeformer
from pliant.space.profile import Profile
from pliant.space.sine import Sine
from pliant.testing import check_deformer


@pytest.mark.parametrize("profile", ["constant", "bump", KEYS, Profile(square, twice)])
def test_obeys_the_laws_of_deformers(profile):
    sine = Sine.around(POINTS, amplitude=0.1, waves=1.5, phase=0.3, profile=profile, normal=[1, 0, 0], **SKEW)
    check_deformer(sine, POINTS, smooth=smooth(sine))


@settings(deadline=None, max_examples=30)
@given(st.floats(-1, 1), st.floats(-3, 3), st.floats(-7, 7), bounds)
def test_is_the_formula(amplitude, waves, phase, limits):
    sine = Sine(amplitude=amplitude, waves=waves, phase=phase, bounds=limits, normal="y", profile=(0.0, 1.0))
    t = np.clip((POINTS[:, 2] - limits[0]) / (limits[1] - limits[0]), 0, 1)
    shift = amplitude * t * np.sin(2 * np.pi * waves * t - phase)
    assert np.allclose(sine(POINTS), POINTS + np.outer(shift, [0, 1, 0]), atol=1e-13)
    assert np.allclose(np.linalg.det(sine.jacobian(POINTS)), 1, atol=1e-12)
    assert np.allclose(sine.inverse(sine(POINTS)), POINTS, atol=1e-13)


def test_at_rest_the_other_numbers_stay():
    sine = Sine(amplitude=0.5, waves=3.0, phase=0.2)
    assert sine.rest.tolist() == [0.0, 3.0, 0.2]
    assert (sine.moved(sine.rest)(POINTS) == POINTS).all()


def test_a_normal_along_the_axis_is_refused():
    with pytest.raises(InvalidDeformer, match="parallel"):
        Sine(axis="z", normal=[0, 0, -3])
