"""Profiles: names, numbers, keys; slopes and integrals agree with their values."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import PchipInterpolator

from pliant.space.profile import NAMED, Curve, as_profile

STEPS = np.linspace(0, 1, 501)

keys = st.lists(st.tuples(st.integers(0, 20), st.floats(-2, 2)), min_size=2, max_size=6, unique_by=lambda k: k[0]).map(
    lambda ks: np.array([(t / 20, h) for t, h in sorted(ks)])
)


@pytest.mark.parametrize("given", [*NAMED, 0.7, (0.2, -1.0), [(0, 1), (0.3, 0), (1, 2)], [(0.2, 1, 3), (0.9, 0, -1)]])
def test_slope_and_integral_are_those_of_the_value(given):
    profile = as_profile(given)
    assert isinstance(profile, Curve)
    h = 1e-6
    between = np.array([0.0137, 0.25, 0.4111, 0.77, 0.95])
    slope = (profile.value(between + h) - profile.value(between - h)) / (2 * h)
    assert np.allclose(profile.slope(between), slope, atol=1e-6)
    rise = (profile.integral(between + h) - profile.integral(between - h)) / (2 * h)
    assert np.allclose(profile.value(between), rise, atol=1e-6)
    assert profile.integral(np.zeros(1))[0] == 0


def test_names_are_what_they_say():
    assert as_profile("ramp").value(np.array([0, 0.5, 1.0])).tolist() == [0, 0.5, 1]
    assert as_profile("constant").value(STEPS).tolist() == [1] * 501
    smooth, bump = as_profile("smooth"), as_profile("bump")
    assert np.allclose([*smooth.value(np.array([0.0, 1])), *smooth.slope(np.array([0.0, 1]))], [0, 1, 0, 0])
    assert np.allclose([*bump.value(np.array([0.0, 1])), *bump.integral(np.array([1.0]))], [0, 0, 1])


@settings(deadline=None, max_examples=30)
@given(keys)
def test_keys_are_met_and_joined_without_overshoot(ks):
    profile, (t, h) = as_profile(ks), ks.T
    assert np.allclose(profile.value(t), h, atol=1e-12)
    within = STEPS[np.clip(STEPS, t[0], t[-1]) == STEPS]
    assert np.allclose(profile.value(within), PchipInterpolator(t, h)(within), atol=1e-9)
    assert h.min() - 1e-9 <= profile.value(STEPS).min() <= profile.value(STEPS).max() <= h.max() + 1e-9
    assert np.allclose(profile.value(np.linspace(0, t[0], 5)), h[0])
    assert np.allclose(profile.value(np.linspace(t[-1], 1, 5)), h[-1])
