"""How far points have turned about an axis, against rotations made on purpose and against differences."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from pliant.numerics.rigid.twists import twist_about


def some(seed):
    random = np.random.default_rng(seed)
    axis = random.normal(size=3)
    return random, random.normal(size=(12, 3)), axis / np.linalg.norm(axis)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), angle=st.floats(-3.1, 3.1), swing=st.floats(0, 3.0), size=st.floats(0.1, 5.0))
def test_a_twist_is_found_whatever_swing_shift_and_scale_come_after(seed, angle, swing, size):
    random, points, axis = some(seed)
    aside = np.cross(axis, random.normal(size=3))
    aside /= np.linalg.norm(aside)
    turn = Rotation.from_rotvec(swing * aside) * Rotation.from_rotvec(angle * axis)
    found, _ = twist_about(points, size * turn.apply(points) + random.normal(size=3), axis)
    assert abs(found - angle) < 1e-8


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_its_gradient_is_that_of_differences(seed):
    random, points, axis = some(seed)
    turn = Rotation.from_rotvec(random.uniform(-0.8, 0.8, 3))  # far from where an angle may be told in two ways
    moved = turn.apply(points) + 0.05 * random.normal(size=points.shape)
    _, gradient = twist_about(points, moved, axis)
    way, step = random.normal(size=points.shape), 1e-5
    ahead, behind = (twist_about(points, moved + sign * step * way, axis)[0] for sign in (1, -1))
    assert abs((ahead - behind) / (2 * step) - np.sum(gradient * way)) < 1e-4


@pytest.mark.parametrize("count", [1, 2])
def test_points_on_a_line_tell_of_no_twist(count):
    _, points, axis = some(3)
    angle, gradient = twist_about(points[:count], points[:count] @ np.diag([-1.0, -1, 1]), axis)
    assert angle == 0
    assert not gradient.any()


def test_half_a_turn_aside_gives_numbers_all_the_same():
    _, points, _ = some(4)
    angle, gradient = twist_about(points, points @ np.diag([-1.0, -1.0, 1.0]), np.array([1.0, 0, 0]))
    assert np.isfinite(angle)
    assert np.isfinite(gradient).all()
