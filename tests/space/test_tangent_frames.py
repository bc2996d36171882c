"""Barr's local deformation: the closed form against RK4, and against the bend and the twist that it contains."""

from __future__ import annotations

import numpy as np
import pytest
from barr_cases import POINTS, SKEW

from pliant.errors import InvalidControls, InvalidDeformer
from pliant.space.bend import Bend
from pliant.space.tangent_frames import TangentFrames
from pliant.space.twist import Twist
from pliant.testing import check_deformer

RATES = np.random.default_rng(1).normal(size=(5, 4)) * [0.2, 0.2, 0.4, 0.15]


def smooth(frames):
    count = len(frames.rates)

    def tell(points):
        place = (frames._sections(points) - frames.bounds[0]) / frames._width * count
        return np.abs(place - np.round(place)) > 0.05

    return tell


def test_obeys_the_laws_of_deformers():
    frames = TangentFrames.around(POINTS, rates=RATES, **SKEW)
    check_deformer(frames, POINTS, smooth=smooth(frames))
    check_deformer(frames.moved(frames.rest), POINTS, smooth=smooth(frames))


def test_positions_are_the_integral_of_the_tangents():
    """Integrate R' = R [rate], X' = (1 + stretch) R t by Runge and Kutta's method of fourth order."""
    frames = TangentFrames(bounds=(-1.0, 1.5), rates=RATES)
    length, steps = 2.5 / 5, 200
    state = np.column_stack([np.eye(3), [0, 0, -1.0]])
    found = [state.copy()]
    for rate in RATES:
        x, y, z = rate[:3] / length
        spin = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])

        def slope(s, spin=spin, grown=1 + rate[3]):
            return np.column_stack([s[:, :3] @ spin, grown * s[:, 2]])

        h = length / steps
        for _ in range(steps):
            a = slope(state)
            b = slope(state + h / 2 * a)
            c = slope(state + h / 2 * b)
            d = slope(state + h * c)
            state = state + h / 6 * (a + 2 * b + 2 * c + d)
        found.append(state.copy())
    knots = np.linspace(-1, 1.5, 6)
    for (u, v), s, at in zip([(0, 0), (1, 0), (0, 1), (0.3, -2), (1, 1), (0, 0.5)], knots, found, strict=True):
        expected = at[:, 3] + u * at[:, 0] + v * at[:, 1]
        assert np.allclose(frames([[u, v, s]])[0], expected, atol=1e-10)


def test_a_constant_turn_across_is_a_bend():
    rates = np.zeros((4, 4))
    frames = TangentFrames(axis="y", bounds=(-1.0, 1.0), rates=rates)
    rates[:, :3] = frames._frame[:, :3] @ [0.25, 0, 0]
    bend = Bend(axis="x", normal="z", angle=1.0, bounds=(-1.0, 1.0), center=-1.0)
    points = POINTS * [1, 2, 0.5]
    assert np.allclose(TangentFrames(axis="y", bounds=(-1.0, 1.0), rates=rates)(points), bend(points), atol=1e-13)


def test_a_constant_turn_about_the_axis_is_a_twist():
    rates = np.tile([0, 0, 0.3, 0], (3, 1))
    assert np.allclose(
        TangentFrames(bounds=(-1.0, 2.0), rates=rates)(POINTS), Twist(angle=0.9, bounds=(-1.0, 2.0))(POINTS), atol=1e-13
    )


def test_volume_is_the_stretch_less_the_curvature():
    frames = TangentFrames(bounds=(-1.0, 1.5), rates=RATES)
    inside = POINTS[(POINTS[:, 2] > -1) & (POINTS[:, 2] < 1.5)]
    rate = RATES[np.floor((inside[:, 2] + 1) / 0.5).astype(int)]
    expected = 1 + rate[:, 3] + (rate[:, 0] * inside[:, 1] - rate[:, 1] * inside[:, 0]) / 0.5
    assert np.allclose(np.linalg.det(frames.jacobian(inside)), expected, atol=1e-12)


def test_at_rest_it_is_the_identity_exactly():
    frames = TangentFrames(rates=RATES)
    assert (frames.moved(frames.rest)(POINTS) == POINTS).all()


def test_refusals_name_the_cause():
    with pytest.raises(InvalidDeformer, match="shape"):
        TangentFrames(rates=np.zeros((3, 3)))
    with pytest.raises(InvalidDeformer, match="segment 1"):
        TangentFrames(rates=[[0, 0, 0, 0], [0, 0, 0, -1]])
    with pytest.raises(InvalidControls):
        TangentFrames().moved(np.zeros(3))
