"""Landmark warps: landmarks reach their targets, space follows as theory says, and SciPy agrees."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import RBFInterpolator

from pliant.errors import InvalidDeformer
from pliant.space.radial_basis_warp import RadialBasisWarp
from pliant.space.thin_plate_spline import ThinPlateSpline
from pliant.testing import check_deformer

RANDOM = np.random.default_rng(0)
LANDMARKS = RANDOM.normal(size=(30, 3))
TARGETS = LANDMARKS + 0.1 * RANDOM.normal(size=LANDMARKS.shape)
POINTS = RANDOM.normal(size=(150, 3))
FLAT = LANDMARKS * [1, 1, 0]


def smooth(points):
    """Away from the tips that |x - p| has at the landmarks."""
    return np.linalg.norm(points[:, None] - LANDMARKS, axis=2).min(axis=1) > 0.01


@pytest.mark.parametrize(
    "warp",
    [
        ThinPlateSpline(LANDMARKS, TARGETS),
        ThinPlateSpline(LANDMARKS, TARGETS, regularization=0.1),
        ThinPlateSpline(FLAT, TARGETS),
        RadialBasisWarp(LANDMARKS, TARGETS, support=2.0),
        RadialBasisWarp(LANDMARKS, TARGETS, support=2.0, regularization=0.05),
    ],
)
def test_obeys_the_laws_of_deformers(warp):
    check_deformer(warp, POINTS, smooth=smooth)


@settings(deadline=None, max_examples=25)
@given(st.integers(1, 25), st.integers(0, 1000), st.sampled_from([1e-3, 1.0, 1e4]), st.sampled_from([0.0, 1e3]))
def test_landmarks_reach_their_targets(count, seed, size, offset):
    rng = np.random.default_rng(seed)
    source = size * (rng.normal(size=(count, 3)) + offset)
    goal = source + size * 0.2 * rng.normal(size=source.shape)
    for warp in (ThinPlateSpline(source, goal), RadialBasisWarp(source, goal, support=1.5 * size)):
        assert np.abs(warp(source) - goal).max() < 1e-9 * size


def test_the_thin_plate_agrees_with_scipy():
    for weight in (0.0, 0.3):
        size = np.linalg.norm(np.ptp(LANDMARKS, axis=0))
        other = RBFInterpolator(LANDMARKS, TARGETS - LANDMARKS, kernel="linear", degree=1, smoothing=weight * size)
        warp = ThinPlateSpline(LANDMARKS, TARGETS, regularization=weight)
        assert np.allclose(warp(POINTS), POINTS + other(POINTS), atol=1e-11)


def test_affine_movements_are_reproduced_everywhere():
    linear, shift = RANDOM.normal(size=(3, 3)), [1, 2, 3]
    for weight in (0.0, 0.5):
        warp = ThinPlateSpline(LANDMARKS, LANDMARKS @ linear + shift, regularization=weight)
        assert np.allclose(warp(POINTS), POINTS @ linear + shift, atol=1e-11)


def test_landmarks_in_a_plane_leave_its_normal_alone():
    stretched = ThinPlateSpline(FLAT, FLAT * [2, 1, 1])
    assert np.allclose(stretched(POINTS), POINTS * [2, 1, 1], atol=1e-11)
    line = ThinPlateSpline(LANDMARKS * [0, 1, 0], LANDMARKS * [0, 1, 0] + [5, 0, 0])
    assert np.allclose(line(POINTS), POINTS + [5, 0, 0], atol=1e-11)
    one = ThinPlateSpline(LANDMARKS[:1], TARGETS[:1])
    assert np.allclose(one(POINTS) - POINTS, TARGETS[0] - LANDMARKS[0])


def test_a_compact_warp_ends_at_its_support():
    warp = RadialBasisWarp([[0, 0, 0.0]], [[0.1, 0, 0]], support=1.5)
    r = np.linspace(0, 2, 41)
    expected = 0.1 * np.clip(1 - r / 1.5, 0, 1) ** 4 * (4 * r / 1.5 + 1)
    line = np.outer(r, [0, 0.6, 0.8])
    assert np.allclose(warp(line) - line, np.outer(expected, [1, 0, 0]), atol=1e-15)
    assert (warp(line)[r >= 1.5] == line[r >= 1.5]).all()
    assert np.allclose(warp.jacobian([[0, 0, 0.0]]), np.eye(3))


def test_regularization_smooths():
    def bending(warp):
        weights, _ = warp._system.coefficients(warp.controls - warp.rest)
        return (weights * (warp._basis.matrix() @ weights)).sum()

    energies = [bending(ThinPlateSpline(LANDMARKS, TARGETS, regularization=w)) for w in (0.0, 0.1, 1.0)]
    assert energies[0] > energies[1] > energies[2] > 0


def test_few_and_many_points_are_alike():
    warp = ThinPlateSpline(LANDMARKS, TARGETS)
    many = RANDOM.normal(size=(9001, 3))
    for part in (many[:1], many[:7], many[4090:4099]):
        at = np.flatnonzero((many[:, None] == part[0]).all(axis=2))[0]
        assert np.allclose(warp(many)[at : at + len(part)], warp(part), atol=1e-14)
    gradient = RANDOM.normal(size=many.shape)
    pulled = warp.bind(many).vjp(None, gradient)
    pushed = warp.bind(many).jvp(None, TARGETS)
    assert (pulled * TARGETS).sum() == pytest.approx((pushed * gradient).sum(), rel=1e-10)


def test_what_was_factorised_is_kept():
    warp = ThinPlateSpline(LANDMARKS)
    assert warp.moved(TARGETS)._system is warp._system


def test_refusals_name_the_landmarks():
    with pytest.raises(InvalidDeformer, match="landmarks 3 and 7 are at the same place"):
        ThinPlateSpline(LANDMARKS[[0, 1, 2, 3, 4, 5, 6, 3]])
    with pytest.raises(InvalidDeformer, match="30 landmarks have 29 targets"):
        ThinPlateSpline(LANDMARKS, TARGETS[:-1])
    for build, cause in (
        (lambda: ThinPlateSpline(np.empty((0, 3))), "at least one"),
        (lambda: ThinPlateSpline([[0, 0, np.nan]]), "number 0"),
        (lambda: ThinPlateSpline("points"), "numbers"),
        (lambda: ThinPlateSpline(LANDMARKS, regularization=-1), "regularization"),
        (lambda: RadialBasisWarp(LANDMARKS, support=0), "support"),
    ):
        with pytest.raises(InvalidDeformer, match=cause):
            build()
