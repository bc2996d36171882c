"""Fitting by descent: the gradient is that of the energy, and known shapes are found from coarse to fine."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import pliant as pl
from pliant.errors import InvalidControls, InvalidParameter, InvalidTarget
from pliant.shape.correspondence import Target
from pliant.shape.descent import Energy
from pliant.shape.procrustes import moved


@pytest.mark.parametrize("loss", ["squares", "huber", "tukey"])
@pytest.mark.parametrize("pose", [None, "rigid"])
def test_the_gradient_is_that_of_the_energy(soft, fine, loss, pose, random):
    target = soft.deformer(0.7 * random.normal(size=soft.count))(fine)
    energy = Energy(soft, Target(target, np.pi), 0.1, loss, pose, coarseness=2)
    state = 0.4 * random.normal(size=soft.count + (6 if pose else 0))
    direction = random.normal(size=len(state))
    step = 1e-6
    slope = (energy(state + step * direction)[0] - energy(state - step * direction)[0]) / (2 * step)
    assert energy(state)[1] @ direction == pytest.approx(slope, rel=1e-5)


@pytest.mark.parametrize("loss", ["squares", "huber"])
def test_a_shape_of_the_model_is_found(soft, fine, loss):
    given = 0.6 * np.random.default_rng(4).normal(size=soft.count)
    fitted = soft.descend(soft.deformer(given)(fine), loss=loss)
    assert fitted.distance < 0.01
    np.testing.assert_allclose(fitted.points, soft.instance(fitted.coefficients), atol=1e-12)


def test_a_moved_shape_is_found_with_its_pose(soft, fine):
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_rotvec([0.1, 0.15, -0.1]).as_matrix()
    matrix[:3, 3] = 0.5, -0.2, 0.3
    target = soft.deformer(0.5 * np.random.default_rng(1).normal(size=soft.count))(fine)
    fitted = soft.descend(target.with_points(moved(matrix, target.points)), pose="rigid")
    assert fitted.distance < 0.01
    np.testing.assert_allclose(fitted.points, moved(fitted.pose, soft.instance(fitted.coefficients)), atol=1e-10)


def test_descent_goes_on_where_icp_ended(soft, fine):
    target = soft.deformer(0.8 * np.random.default_rng(7).normal(size=soft.count))(fine)
    rough = soft.fit(target, iterations=4)
    fitted = soft.descend(target, start=rough.coefficients, levels=1)
    energy = Energy(soft, Target(target, np.pi), 1e-3 * soft.reference.diagonal, "huber")
    assert energy(fitted.coefficients)[0] < energy(rough.coefficients)[0]
    assert fitted.distance < rough.distance


def test_spoilt_points_do_not_count(soft):
    given = 0.5 * np.random.default_rng(3).normal(size=soft.count)
    points = soft.instance(given)
    spoilt = points.copy()
    spoilt[100:110] += [0, 0, 1.5]
    fitted = soft.descend(soft.reference.with_points(spoilt), loss="tukey")
    whole = Target(soft.reference.with_points(points), np.pi)
    away = np.linalg.norm(whole.closest(fitted.points) - fitted.points, axis=1)
    assert np.median(away) < 0.01


def test_what_cannot_be_fitted_is_refused_by_name(soft, fine):
    with pytest.raises(InvalidParameter, match="'similarity'"):
        soft.descend(fine, pose="similarity")
    with pytest.raises(InvalidControls):
        soft.descend(fine, start=[1.0])
    for fit in (soft.fit, soft.descend):
        with pytest.raises(InvalidTarget, match="one unit of length"):
            fit(fine.with_points(1000 * fine.points))
        with pytest.raises(InvalidTarget, match="pose='rigid'"):
            fit(fine.with_points(fine.points + 100))
        with pytest.raises(InvalidTarget, match="no points"):
            fit(pl.PolygonMesh(np.empty((0, 3))))
