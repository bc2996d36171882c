"""Twist: against plain NumPy, Barr's normals, volume, and the exact inverse."""

from __future__ import annotations

import numpy as np
import pytest
from barr_cases import KEYS, POINTS, SKEW, bounds, directions, smooth, square, twice
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import InvalidControls, InvalidDeformer, InvalidTarget, NonFiniteResult
from pliant.numerics.maps.normals import carry_normals
from pliant.space.affine import Affine
from pliant.space.profile import Profile
from pliant.space.twist import Twist
from pliant.testing import check_deformer


def naive(points, angle, low, high, origin):
    theta = angle * np.clip((points[:, 2] - low) / (high - low), 0, 1)
    x, y = points[:, 0] - origin[0], points[:, 1] - origin[1]
    c, s = np.cos(theta), np.sin(theta)
    return np.stack([c * x - s * y + origin[0], s * x + c * y + origin[1], points[:, 2]], axis=1)


@pytest.mark.parametrize("profile", ["ramp", "smooth", 0.7, (0.2, -0.5), KEYS, Profile(square, twice)])
def test_obeys_the_laws_of_deformers(profile):
    twist = Twist.around(POINTS, angle=1.2, profile=profile, **SKEW)
    check_deformer(twist, POINTS, smooth=smooth(twist))


@settings(deadline=None, max_examples=30)
@given(st.floats(-20, 20), bounds, st.integers(1, 40))
def test_is_the_formula(angle, limits, count):
    twist = Twist(angle=angle, bounds=limits, origin=[0.3, -0.2, 9.0])
    expected = naive(POINTS[:count], angle, *limits, [0.3, -0.2])
    assert np.abs(twist(POINTS[:count]) - expected).max() < 1e-14 * (10 + abs(angle))


@settings(deadline=None, max_examples=30)
@given(directions, st.floats(-5, 5), bounds)
def test_any_axis_is_the_z_axis_turned(axis, angle, limits):
    """Conjugate with a rotation that takes z to the axis."""
    unit = np.array(axis) / np.linalg.norm(axis)
    cross, cosine = np.cross([0, 0, 1.0], unit), unit[2]
    about = cross if np.linalg.norm(cross) > 1e-9 else np.array([1.0, 0, 0])
    turn = Affine.rotation(about, np.arctan2(np.linalg.norm(cross), cosine))
    straight = Twist(angle=angle, bounds=limits)
    expected = turn(straight(turn.inverse(POINTS)))
    assert np.allclose(Twist(angle=angle, bounds=limits, axis=axis)(POINTS), expected, atol=1e-12)


@settings(deadline=None, max_examples=20)
@given(directions, st.floats(-9, 9), bounds)
def test_volume_is_kept_and_the_inverse_is_exact(axis, angle, limits):
    twist = Twist(angle=angle, bounds=limits, axis=axis, profile="smooth")
    assert np.abs(np.linalg.det(twist.jacobian(POINTS)) - 1).max() < 1e-12
    assert np.abs(twist.inverse(twist(POINTS)) - POINTS).max() < 1e-13


def test_normals_are_barrs():
    twist = Twist(angle=0.8, bounds=(-5.0, 5.0))
    normals = np.random.default_rng(1).normal(size=POINTS.shape)
    slope = 0.08
    theta = slope * (POINTS[:, 2] + 5)
    (x, y, _), (nx, ny, nz), c, s = POINTS.T, normals.T, np.cos(theta), np.sin(theta)
    expected = np.stack([c * nx - s * ny, s * nx + c * ny, slope * (y * nx - x * ny) + nz], axis=1)
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    assert np.allclose(carry_normals(twist.jacobian(POINTS), normals), expected, atol=1e-14)


def test_the_table_and_the_fused_kernel_agree():
    """Functions go by the table, curves by a kernel of their own."""
    functions = Profile(lambda t: 3 * t**2 - 2 * t**3, lambda t: 6 * t - 6 * t**2)
    for count in (0, 1, 7, 8, 9, 100):
        one, two = (Twist.around(POINTS, angle=2.0, profile=p, **SKEW) for p in ("smooth", functions))
        assert np.allclose(one(POINTS[:count]), two(POINTS[:count]), atol=1e-14)
        assert np.allclose(one.jacobian(POINTS[:count]), two.jacobian(POINTS[:count]), atol=1e-13)


def test_many_points_go_through_in_pieces():
    points = np.random.default_rng(0).random((70_003, 3))
    for profile in ("ramp", Profile(np.copy, np.ones_like)):
        twist = Twist(angle=3.0, profile=profile)
        assert np.abs(twist(points) - naive(points, 3.0, 0, 1, [0, 0])).max() < 1e-14
        assert np.allclose(twist.jacobian(points)[-5:], twist.jacobian(points[-5:]), atol=1e-14)


def test_a_parameter_is_the_control():
    twist = Twist(angle=0.5)
    assert twist.controls.tolist() == [0.5]
    assert twist.moved([0.7]).angle == 0.7
    assert (twist.moved(twist.rest)(POINTS) == POINTS).all()


def test_refusals_name_the_cause():
    for fields, cause in (
        ({"axis": [0, 0, 0]}, "no direction"),
        ({"axis": "w"}, "no axis"),
        ({"axis": [1, 2]}, "three"),
        ({"bounds": (2, 1)}, "reversed"),
        ({"bounds": (1, 1)}, "empty"),
        ({"bounds": (0, np.inf)}, "finite"),
        ({"bounds": 3}, "two numbers"),
        ({"origin": [np.nan, 0, 0]}, "finite"),
        ({"angle": np.inf}, "finite"),
        ({"angle": "much"}, "number"),
        ({"profile": "hill"}, "no profile"),
        ({"profile": [(0.5, 1), (0.2, 0)]}, "ascend"),
        ({"profile": [(-1, 1), (0.2, 0)]}, "ascend"),
        ({"profile": np.zeros((3, 5))}, "shape"),
        ({"profile": [1, np.nan]}, "finite"),
        ({"profile": object()}, "no profile"),
    ):
        with pytest.raises(InvalidDeformer, match=cause):
            Twist(**fields)
    with pytest.raises(InvalidControls):
        Twist().moved([1.0, 2.0])
    with pytest.raises(InvalidTarget):
        Twist.around(np.empty((0, 3)))
    with pytest.raises(NonFiniteResult):
        Twist(angle=1.0)(np.full((1, 3), 1.5e308))


def test_a_flat_shape_has_bounds_too():
    flat = POINTS * [1, 1, 0]
    low, high = Twist.around(flat, axis="z", angle=1.0).bounds
    assert low < 0 < high
    one = Twist.around(flat[:1], axis="z", angle=1.0)
    assert np.isfinite(one(POINTS)).all()
