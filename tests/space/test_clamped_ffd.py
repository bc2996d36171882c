"""Clamped B-spline boxes: the identity at rest, SciPy's splines at the solved parameters, Bernstein where small."""

import numpy as np
import pytest
from scipy.interpolate import NdBSpline

from pliant.numerics.lattices.clamped import parameters, pieces, spans
from pliant.space.bezier_ffd import BezierFFD
from pliant.space.clamped_ffd import ClampedFFD
from pliant.testing import check_deformer


def bent(points, shape, size=0.05):
    ffd = ClampedFFD.around(points, shape=shape)
    return ffd.moved(ffd.rest + np.random.default_rng(3).normal(size=ffd.rest.shape) * size)


def knots(count):
    degree = min(3, count - 1)
    return np.concatenate([np.zeros(degree), np.arange(spans(count) + 1.0), np.full(degree, float(spans(count)))])


@pytest.mark.parametrize("shape", [(6, 5, 8), (2, 7, 3), (4, 4, 4)])
def test_laws(random, shape):
    points = random.random((200, 3)) * [2, 3, 1]
    ffd = bent(points, shape)
    check_deformer(ffd, points[(np.abs((points - ffd.origin) / np.diag(ffd.edges) - 0.5) < 0.49).all(axis=1)])


def test_agrees_with_scipy(random):
    points = random.random((300, 3)) * [2, 3, 1]
    ffd = bent(points, (6, 5, 8))
    t = (points - ffd.origin) / np.diag(ffd.edges)
    s = np.stack([parameters(n, t[:, axis])[0] for axis, n in enumerate(ffd.shape)], axis=1)
    volume = NdBSpline(tuple(knots(n) for n in ffd.shape), ffd.controls, 3)
    assert np.abs(ffd(points) - volume(s)).max() < 1e-13
    undeformed = NdBSpline(tuple(knots(n) for n in ffd.shape), ffd.rest, 3)
    assert np.abs(undeformed(s) - points).max() < 1e-13


@pytest.mark.parametrize("shape", [(4, 4, 4), (2, 3, 4)])
def test_small_lattices_are_bernstein(random, shape):
    points = random.random((200, 3)) * 1.2 - 0.1
    ffd = bent(np.eye(3), shape)
    bezier = BezierFFD(displacements=ffd.displacements, origin=ffd.origin, edges=ffd.edges)
    assert np.abs(ffd(points) - bezier(points)).max() < 1e-14


@pytest.mark.parametrize("count", [2, 3, 4, 5, 6, 9, 30])
def test_even_control_values_are_met_and_their_slope_is_the_derivative(count):
    t = np.linspace(0, 1, 401)
    s, slope = parameters(count, t)
    from scipy.interpolate import BSpline

    curve = BSpline(knots(count), np.linspace(0, 1, count), min(3, count - 1))
    assert np.abs(curve(s) - t).max() < 1e-14
    assert np.abs(curve.derivative()(s) - slope)[1:-1].max() < 1e-12
    assert np.abs(pieces(count).sum(axis=1) - 1).max() < 1e-13
