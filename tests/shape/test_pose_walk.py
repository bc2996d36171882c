"""Chains over poses: rotations are uniform where nothing is known, and the pose of a target is found."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pliant.errors import InvalidParameter
from pliant.numerics.rigid.rotations import rotations_of
from pliant.shape.closest_point_chain import ClosestPointDensity
from pliant.shape.correspondence import Target
from pliant.shape.kernels import GaussianKernel
from pliant.shape.model import ShapeModel
from pliant.shape.pose_walk import PoseWalk, exponential_volume, pose_matrix, rotation_vector, turning_rate
from pliant.shape.procrustes import moved
from pliant.shape.sampling import Mixture, RandomWalk, metropolis_hastings


def test_the_turning_rate_is_that_of_the_exponential(random):
    for vector in (*random.normal(size=(5, 3)), 1e-6 * random.normal(size=3)):
        change = 1e-6 * random.normal(size=3)
        after = rotations_of(vector[None] + change)[0] @ rotations_of(vector[None])[0].T
        np.testing.assert_allclose(rotation_vector(after), turning_rate(vector) @ change, atol=1e-11)
        assert np.linalg.det(turning_rate(vector)) == pytest.approx(exponential_volume(vector), rel=1e-9)


def test_densities_of_turns_integrate_to_one():
    walk, axis = PoseWalk(0.45, 1.0), np.linspace(-3.2, 3.2, 21)
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    grid = grid[np.linalg.norm(grid, axis=1) < np.pi]
    state, turned = np.zeros(6), np.zeros((len(grid), 6))
    state[:3], turned[:, :3] = (1.0, -0.5, 0.3), grid
    shift = -1.5 * np.log(2 * np.pi)  # the density of no shift
    total = np.exp([walk.log_density(each, state) - shift for each in turned]).sum() * (axis[1] - axis[0]) ** 3
    assert total == pytest.approx(1, abs=5e-3)


def test_rotations_are_uniform_where_nothing_is_known():
    def density(state):
        return np.log(exponential_volume(state[:3])) - 0.5 * float(state[3:] @ state[3:])

    chains = metropolis_hastings(density, PoseWalk(0.45, 0.8), np.zeros((2, 6)), 2500, seed=0)
    angle = np.linalg.norm(chains.samples[:, 300:, :3].reshape(-1, 3), axis=1)
    expected = np.pi / 2 + 2 / np.pi  # the mean angle of uniform rotations: density (1 - cos) / pi
    assert angle.mean() == pytest.approx(expected, abs=0.12)
    directions = Rotation.from_rotvec(chains.samples[:, 300:, :3].reshape(-1, 3)).apply([0, 0, 1])
    assert np.abs(directions.mean(axis=0)).max() < 0.2


def test_the_pose_of_a_target_is_found(coarse, fine):
    model = ShapeModel.from_kernel(coarse, GaussianKernel(3.0, 0.1), rank=8)
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = Rotation.from_rotvec([0.2, 0.1, -0.2]).as_matrix(), (0.4, -0.3, 0.2)
    target = model.deformer(np.random.default_rng(1).normal(size=model.count))(fine)
    target = target.with_points(moved(matrix, target.points))
    density = ClosestPointDensity(model, target, noise=0.1, pose="rigid")
    steps = Mixture([density.proposal(0.3), PoseWalk(0.02, 0.02), RandomWalk(0.05, first=6)], [0.4, 0.4, 0.2])
    chains = metropolis_hastings(density, steps, np.zeros(6 + model.count), 700, seed=0)
    state = chains.best
    shape = moved(pose_matrix(state, model.mean.mean(axis=0)), model.instance(state[6:]))
    assert np.linalg.norm(Target(target, np.pi).closest(shape) - shape, axis=1).mean() < 0.06
    still = (np.diff(chains.samples[0, :, :6], axis=0) == 0).all(axis=1)
    assert 0 < still.mean() < 1


def test_steps_that_move_another_part_have_no_density():
    new, state = np.arange(8.0), np.zeros(8)
    assert PoseWalk(0.1, 1).log_density(new, state) == -np.inf
    assert RandomWalk(0.1, first=6).log_density(new, state) == -np.inf
    with pytest.raises(InvalidParameter, match=r"below 0\.5 radians"):
        PoseWalk(0.6, 1)
