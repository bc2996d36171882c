"""Direct manipulation: the least move that does it, for every kind of linear deformer."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import InvalidDeformer, InvalidParameter, PliantWarning
from pliant.space.affine import Affine
from pliant.space.bezier_ffd import BezierFFD
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.direct import pull
from pliant.space.scale import Scale
from pliant.space.thin_plate_spline import ThinPlateSpline
from pliant.space.twist import Twist

POINTS = np.random.default_rng(8).uniform(-1, 1, size=(50, 3))
LATTICE = BSplineFFD.around(POINTS, shape=(6, 6, 6))


@settings(deadline=None, max_examples=15)
@given(st.integers(1, 6), st.integers(0, 5), st.integers(0, 1000))
def test_points_reach_their_targets_and_pins_stay(count, pins, seed):
    rng = np.random.default_rng(seed)
    chosen = rng.choice(len(POINTS), count + pins, replace=False)
    held, fixed = POINTS[chosen[:count]], POINTS[chosen[count:]]
    goals = held + rng.normal(size=held.shape) * 0.1
    pulled = pull(LATTICE, held, goals, pins=fixed)
    assert np.allclose(pulled(held), goals, atol=1e-10)
    assert np.allclose(pulled(fixed), fixed, atol=1e-10)


@pytest.mark.parametrize(
    "deformer", [LATTICE, BezierFFD.around(POINTS, shape=(5, 4, 4)), ThinPlateSpline(POINTS[:9] * 1.1)]
)
def test_it_starts_from_what_is_and_moves_the_least(deformer):
    """The textbook's formula, with weights, in plain NumPy."""
    rng = np.random.default_rng(0)
    moved = deformer.moved(deformer.rest + 0.05 * rng.normal(size=deformer.rest.shape))
    held, goals = POINTS[:4], POINTS[:4] + [0.1, 0, -0.2]
    shape = deformer.rest.shape[:-1]
    resistance = rng.uniform(0.5, 2, size=shape)
    pulled = pull(moved, held, goals, weights=resistance)
    matrix = moved.bind(held).weights @ np.eye(resistance.size)
    give = 1 / resistance.reshape(-1)
    step = give[:, None] * matrix.T @ np.linalg.solve((matrix * give) @ matrix.T, goals - moved(held))
    assert np.allclose((pulled.controls - moved.controls).reshape(-1, 3), step, atol=1e-8)
    assert np.allclose(pulled(held), goals, atol=1e-10)


def test_coefficients_are_pulled_too():
    assert np.allclose(pull(Scale(), [[1, 2, 3.0]], [[2, 2, 1.5]]).controls, [2, 1, 0.5])
    goal = Affine.of([[1, 0.5, 0], [0, 2, 0.2], [0.3, 0, 2]], [1, 2, 3])
    assert np.allclose(pull(Affine(), POINTS[:4], goal(POINTS[:4])).matrix, goal.matrix, atol=1e-10)


def test_frozen_control_points_stay():
    held, goals = POINTS[:2], POINTS[:2] + 0.1
    mask = np.zeros(LATTICE.shape, bool)
    mask[:2] = True
    for frozen in (mask, np.argwhere(mask)):
        pulled = pull(LATTICE, held, goals, frozen=frozen)
        assert (pulled.displacements[:2] == 0).all()
        assert np.allclose(pulled(held), goals, atol=1e-10)


def test_regularization_trades_reaching_for_moving():
    held, goals = POINTS[:3], POINTS[:3] + 0.3
    sizes, misses = [], []
    for weight in (0.0, 0.01, 0.1, 1.0):
        pulled = pull(LATTICE, held, goals, regularization=weight)
        sizes.append(np.linalg.norm(pulled.displacements))
        misses.append(np.linalg.norm(pulled(held) - goals))
    assert misses[0] < 1e-10
    assert (np.diff(sizes) < 0).all()
    assert (np.diff(misses) > 0).all()


def test_points_given_twice_with_one_wish_are_no_trouble():
    held, goals = POINTS[[0, 0, 1]], POINTS[[0, 0, 1]] + 0.1
    assert np.allclose(pull(LATTICE, held, goals)(held), goals, atol=1e-10)


def test_what_cannot_be_is_told():
    with pytest.raises(InvalidParameter, match="0 and 1 contradict"):
        pull(LATTICE, POINTS[[0, 0]], [POINTS[1], POINTS[2]])
    with pytest.raises(InvalidParameter, match="0 and 1 contradict"):
        pull(LATTICE, POINTS[:1], POINTS[:1] + 1, pins=POINTS[:1])
    far = BezierFFD.around(POINTS)
    with pytest.raises(InvalidParameter, match="reaches constraint 1"):
        pull(far, [POINTS[0], [9, 9, 9.0]], [POINTS[0], [8, 9, 9.0]])
    with pytest.raises(InvalidParameter, match="2 points have 1 targets"):
        pull(LATTICE, POINTS[:2], POINTS[:1])
    with pytest.raises(InvalidDeformer, match="not linear"):
        pull(Twist(), POINTS[:2], POINTS[:2])
    for extra, cause in (
        ({"weights": np.ones(3)}, "shape"),
        ({"weights": np.zeros(LATTICE.shape)}, "positive"),
        ({"frozen": [[9, 0, 0]]}, "not among"),
        ({"frozen": np.ones(3, bool)}, "mask"),
        ({"regularization": -1}, "regularization"),
    ):
        with pytest.raises(InvalidParameter, match=cause):
            pull(LATTICE, POINTS[:2], POINTS[:2] + 1, **extra)


def test_a_lattice_that_is_too_coarse_says_so():
    coarse = BezierFFD.around(POINTS, shape=(2, 2, 2))
    with pytest.warns(PliantWarning, match="missed by up to"):
        pull(coarse, POINTS[:20], POINTS[:20] + np.random.default_rng(0).normal(size=(20, 3)))
    close = POINTS[0] + np.array([[0, 0, 0], [1e-6, 0, 0]])
    with pytest.warns(PliantWarning, match="too coarse"):
        pull(LATTICE, close, close + [[0.1, 0, 0], [0, 0.1, 0]])
