"""Bend: against Barr's formulas in plain NumPy, near k = 0, through the fold, and back."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from barr_cases import POINTS, bounds, directions, smooth
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pliant.errors import InvalidDeformer, NotConverged, PliantWarning
from pliant.numerics.maps.normals import carry_normals
from pliant.space.bend import Bend
from pliant.testing import check_deformer

THIN = POINTS * [1, 1, 0.2]


def barr(points, k, low, high, center):
    """About x, along y: Barr 1984, section 3.4, with the division by k that must not be done near zero."""
    x, y, z = points.T
    inside = np.clip(y, low, high)
    theta = k * (inside - center)
    c, s = np.cos(theta), np.sin(theta)
    new_y = -s * (z - 1 / k) + center + c * (y - inside)
    new_z = c * (z - 1 / k) + 1 / k + s * (y - inside)
    return np.stack([x, new_y, new_z], axis=1)


@pytest.mark.parametrize(
    "fields",
    [
        {"axis": "y", "normal": "z", "angle": 0.6},
        {"axis": [1, 0, 0.2], "normal": [0, 1, 1], "angle": -0.9},
        {"axis": "x", "normal": "z", "angle": 1.0, "bounds": (-0.6, 0.4), "center": 0.3},
    ],
)
def test_obeys_the_laws_of_deformers(fields):
    bend = Bend.around(THIN, **fields)
    check_deformer(bend, THIN, smooth=smooth(bend))


@settings(deadline=None, max_examples=40)
@given(st.floats(0.01, 2), bounds, st.floats(-2, 2), st.sampled_from([1, -1]))
def test_is_barrs_formula(angle, limits, center, sign):
    width = limits[1] - limits[0]
    k = sign * angle / width
    assume(np.abs(k * THIN[:, 2]).max() < 0.9)
    bend = Bend(angle=sign * angle, bounds=limits, center=center)
    assert np.allclose(bend.along, [0, 1, 0])
    assert np.allclose(bend(THIN), barr(THIN, k, *limits, center), atol=1e-13 * (1 + 1 / abs(k)))
    between = (THIN[:, 1] >= limits[0]) & (THIN[:, 1] <= limits[1])
    assert np.allclose(np.linalg.det(bend.jacobian(THIN)), 1 - np.where(between, k, 0) * THIN[:, 2], atol=1e-12)
    assert np.allclose(bend.inverse(bend(THIN)), THIN, atol=1e-11)


def test_normals_are_barrs():
    bend = Bend(angle=0.8, bounds=(-10.0, 10.0), center=0.0)
    normals = np.random.default_rng(1).normal(size=POINTS.shape)
    k = 0.04
    c, s, q = np.cos(k * POINTS[:, 1]), np.sin(k * POINTS[:, 1]), 1 - k * POINTS[:, 2]
    nx, ny, nz = normals.T
    expected = np.stack([q * nx, c * ny - q * s * nz, s * ny + q * c * nz], axis=1)
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    assert np.allclose(carry_normals(bend.jacobian(POINTS), normals), expected, atol=1e-14)


@pytest.mark.parametrize("angle", [0.0, 1e-300, 1e-18, 1e-9, 1e-6])
def test_no_curvature_is_no_change_and_no_division(angle):
    bend = Bend(angle=angle, bounds=(-1.0, 1.0))
    expected = POINTS + angle / 2 * np.column_stack(
        [0 * POINTS[:, 0], -POINTS[:, 2] * np.clip(POINTS[:, 1], -1, 1), _rise(POINTS[:, 1])]
    )  # to first order in the angle
    assert np.abs(bend(POINTS) - expected).max() <= 10 * angle**2 + 1e-15
    assert np.allclose(bend.inverse(bend(POINTS)), POINTS, atol=1e-14)
    slope = bend.bind(POINTS).jvp(None, [1.0])
    assert np.allclose(slope, (expected - POINTS) / angle if angle > 1e-8 else slope, atol=1e-5)


def _rise(y):
    inside = np.clip(y, -1, 1)
    return inside**2 / 2 + inside * (y - inside)


@settings(deadline=None, max_examples=20)
@given(directions, directions, st.floats(-0.5, 0.5))
def test_ends_rise_towards_the_normal_and_lengths_stay(axis, normal, angle):
    axis, normal = np.array(axis), np.array(normal)
    assume(np.linalg.norm(np.cross(axis, normal)) > 0.1)
    bend = Bend(axis=axis, normal=normal, angle=angle, bounds=(-1.0, 1.0))
    line = np.linspace(-1, 1, 2001)[:, None] * bend.along
    arc = bend(line)
    lengths = np.linalg.norm(np.diff(arc, axis=0), axis=1)
    assert np.isclose(lengths.sum(), 2.0, atol=1e-6)
    assert np.allclose(arc[1000], 0, atol=1e-12)
    rise = (arc - line) @ bend._frame[0, :3]
    assert (rise * np.sign(angle) >= -1e-12).all()


def test_beyond_the_fold_it_warns_with_a_count_and_goes_on():
    bend = Bend(angle=2.0, bounds=(-1.0, 1.0))
    points = np.array([[0, 0, 0.5], [0, 0.2, 1.5], [0, 0.3, 3.0], [0, 4.0, 3.0]])
    with pytest.warns(PliantWarning, match="2 of 4 points"):
        folded = bend(points)
    assert np.isfinite(folded).all()
    with pytest.raises(NotConverged, match="1 of 1 points"):
        bend.inverse([[0, 0, 1.0]])  # the centre of curvature: a whole line goes there
    assert np.allclose(bend(bend.inverse(folded)), folded, atol=1e-12)  # what does not fold reaches there too
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bend(points[[0, 3]])


def test_refusals_name_the_cause():
    with pytest.raises(InvalidDeformer, match="parallel"):
        Bend(axis="x", normal=[2, 0, 0])
    with pytest.raises(InvalidDeformer, match="center"):
        Bend(center=np.nan)
    with pytest.raises(InvalidDeformer, match="normal"):
        Bend(normal=[0, 0, 0])
