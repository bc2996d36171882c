"""Fitting by descent: the gradient is that of the energy, and known shapes are found from coarse to fine."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

import pliant as pl
from pliant.errors import InvalidControls, InvalidParameter, InvalidTarget, NotConverged
from pliant.shape.correspondence import Target
from pliant.shape.descent_energy import FREE, Energy
from pliant.shape.procrustes import moved


@pytest.mark.parametrize("loss", ["squares", "huber", "tukey"])
@pytest.mark.parametrize("pose", [None, "rigid", "similarity"])
def test_the_gradient_is_that_of_the_energy(soft, fine, loss, pose, random):
    target = soft.deformer(0.7 * random.normal(size=soft.count))(fine)
    energy = Energy(soft, Target(target, np.pi / 3), 0.1, loss, pose, coarseness=2)
    state = 0.4 * random.normal(size=soft.count + FREE[pose])
    energy.believe(state)
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


@pytest.mark.parametrize(("pose", "scale"), [("rigid", 1.0), ("similarity", 1.0), ("similarity", 40.0)])
def test_a_moved_shape_is_found_with_its_pose(soft, fine, pose, scale):
    matrix = np.eye(4)
    matrix[:3, :3] = scale * Rotation.from_rotvec([0.1, 0.15, -0.1]).as_matrix()
    matrix[:3, 3] = 0.5, -0.2, 0.3
    target = soft.deformer(0.5 * np.random.default_rng(1).normal(size=soft.count))(fine)
    fitted = soft.descend(target.with_points(moved(matrix, target.points)), pose=pose)
    assert fitted.status == "converged"
    assert fitted.distance < 0.01 * scale
    assert np.cbrt(np.linalg.det(fitted.pose[:3, :3])) == pytest.approx(scale, rel=0.05)
    np.testing.assert_allclose(fitted.points, moved(fitted.pose, soft.instance(fitted.coefficients)), atol=1e-10)


def test_descent_goes_on_where_icp_ended(soft, fine):
    target = soft.deformer(0.8 * np.random.default_rng(7).normal(size=soft.count))(fine)
    rough = soft.fit(target, iterations=4)
    fitted = soft.descend(target, start=rough.coefficients, levels=1)
    energy = Energy(soft, Target(target, np.pi), 1e-3 * soft.reference.diagonal, "huber")
    assert energy(fitted.coefficients)[0] < energy(rough.coefficients)[0]
    assert fitted.distance < rough.distance


@pytest.mark.parametrize("pose", [None, "similarity"])
def test_converged_means_that_next_to_nothing_is_left_to_descend(soft, fine, pose, random):
    target = soft.deformer(0.6 * random.normal(size=soft.count))(fine)
    fitted = soft.descend(target, pose=pose)
    assert fitted.status == "converged"
    energy = Energy(soft, Target(target, np.pi / 3), 1e-3 * soft.reference.diagonal, "huber", pose)
    best = minimize(energy, state_of(fitted, soft, pose), jac=True, method="L-BFGS-B", options={"maxiter": 400}).fun
    assert energy(state_of(fitted, soft, pose))[0] - best < 0.02  # of a logarithm of probability
    assert soft.descend(target, pose=pose, iterations=1, levels=1).status == "stopped"


def state_of(fitted, model, pose):
    """The numbers of a fit: its pose about the mean's centre, and its coefficients."""
    if pose is None:
        return fitted.coefficients
    scale = np.cbrt(np.linalg.det(fitted.pose[:3, :3]))
    center = model.mean.mean(axis=0)
    turn = Rotation.from_matrix(fitted.pose[:3, :3] / scale).as_rotvec()
    shift = moved(fitted.pose, center[None])[0] - center
    return np.concatenate([turn, shift, [np.log(scale)][: FREE[pose] - 6], fitted.coefficients])


def test_newton_s_step_ends_at_the_least_squares_of_a_flat_target(soft):
    """Where the target is a plane, distances are linear: one step from anywhere is all that it takes."""
    corners = 50.0 * np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) + [0, 0, -3.0]
    plane = Target(pl.PolygonMesh(corners, [[0, 1, 2, 3]]), np.pi)
    energy = Energy(soft, plane, 0.1, "squares")
    state = np.zeros(soft.count)
    state = state + energy.newton(state, energy(state)[1])
    assert np.abs(energy(state)[1]).max() < 1e-6 * np.abs(energy(np.zeros(soft.count))[1]).max()


def test_the_other_side_of_a_thin_wall_does_not_correspond(soft, fine):
    """A target with a second skin close inside it, turned inwards: normals tell the two apart."""
    outer = soft.deformer(0.4 * np.random.default_rng(9).normal(size=soft.count))(fine)
    inner = outer.points - 0.08 * outer.vertex_normals
    count = len(outer.points)
    faces = np.vstack([outer.triangles, outer.triangles[:, ::-1] + count])
    wall = pl.PolygonMesh(np.vstack([outer.points, inner]), faces)
    away = {}
    for angle in (np.pi / 3, np.pi):
        fitted = soft.descend(wall, angle=angle)
        away[angle] = np.linalg.norm(Target(outer, np.pi).closest(fitted.points) - fitted.points, axis=1).mean()
    assert away[np.pi / 3] < 0.01
    assert away[np.pi / 3] < 0.8 * away[np.pi]


def test_normals_that_point_inwards_are_told(soft, fine):
    with pytest.raises(NotConverged, match="turn normals that point inwards"):
        soft.descend(pl.PolygonMesh(fine.points, fine.triangles[:, ::-1]))


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
    with pytest.raises(InvalidParameter, match="'bent'"):
        soft.descend(fine, pose="bent")
    with pytest.raises(InvalidControls):
        soft.descend(fine, start=[1.0])
    for fit in (soft.fit, soft.descend):
        with pytest.raises(InvalidTarget, match="one unit of length"):
            fit(fine.with_points(1000 * fine.points))
        with pytest.raises(InvalidTarget, match="pose='rigid'"):
            fit(fine.with_points(fine.points + 100))
        with pytest.raises(InvalidTarget, match="no points"):
            fit(pl.PolygonMesh(np.empty((0, 3))))
