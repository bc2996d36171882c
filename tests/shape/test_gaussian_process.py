"""Gaussian processes without a mesh, against the dense formulas."""

import numpy as np
import pytest

import pliant as pl
from pliant.errors import InvalidParameter
from pliant.shape.matrix_kernels import DiagonalKernel, DirectedKernel
from pliant.shape.posterior import along_and_across
from pliant.testing import check_deformer

SCALAR = pl.GaussianKernel(1.0, 0.3) + pl.MaternKernel(2.0, 0.1)
MATRIX = pl.GaussianKernel(1.0, 0.3) + DirectedKernel(pl.GaussianKernel(2.0, 0.2), [[2, 1, 0], [1, 3, 0], [0, 0, 0.1]])


def dense(kernel, x, y):
    full = DiagonalKernel(kernel, kernel, kernel) if kernel.scalar else kernel
    return full(x, y).reshape(3 * len(x), 3 * len(y))


@pytest.fixture(params=[SCALAR, MATRIX], ids=["scalar", "matrix"])
def kernel(request):
    return request.param


@pytest.fixture
def seen(random):
    return random.normal(size=(6, 3)), 0.3 * random.normal(size=(6, 3))


@pytest.mark.parametrize(
    "noise", [0.05, np.linspace(0.01, 0.1, 6), along_and_across(np.eye(3)[[0, 1, 2] * 2], 0.01, 0.3)]
)
def test_mean_and_covariance_are_those_of_the_dense_formula(kernel, seen, noise, random):
    points, values = seen
    process = pl.GaussianProcess(kernel).posterior(points, values, noise=noise)
    error = np.zeros((18, 18))
    for i in range(6):
        one = noise[i] if np.ndim(noise) == 3 else np.broadcast_to(noise, 6)[i] ** 2 * np.eye(3)
        error[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = one
    x = random.normal(size=(9, 3))
    inner, across = dense(kernel, points, points) + error, dense(kernel, x, points)
    np.testing.assert_allclose(
        process.mean(x).reshape(-1), across @ np.linalg.solve(inner, values.reshape(-1)), atol=1e-7
    )
    expected = dense(kernel, x, x) - across @ np.linalg.solve(inner, across.T)
    np.testing.assert_allclose(process.covariance(x).reshape(27, 27), expected, atol=1e-7)


def test_observing_in_turn_is_observing_at_once(kernel, seen):
    points, values = seen
    at_once = pl.GaussianProcess(kernel).posterior(points, values, noise=0.05)
    errors = np.broadcast_to(0.05**2 * np.eye(3), (4, 3, 3))
    in_turn = pl.GaussianProcess(kernel).posterior(points[:2], values[:2], noise=0.05)
    in_turn = in_turn.posterior(points[2:], values[2:], noise=errors)
    np.testing.assert_allclose(in_turn.mean(points + 0.3), at_once.mean(points + 0.3), atol=1e-9)


def test_samples_of_the_posterior_have_its_mean_and_covariance(kernel, seen, random):
    points, values = seen
    process = pl.GaussianProcess(kernel).posterior(points, values, noise=0.1)
    x = points[:4] + 0.2 * random.normal(size=(4, 3))
    fields = process.fields(np.vstack([x, points]), tolerance=1e-8)
    columns = fields.at(x).columns().reshape(12, -1)
    np.testing.assert_allclose(columns @ columns.T, process.covariance(x).reshape(12, 12), atol=5e-4)
    np.testing.assert_allclose(fields.mean(x), process.mean(x), atol=1e-12)


def test_samples_agree_with_what_was_seen(kernel, seen):
    points, values = seen
    process = pl.GaussianProcess(kernel).posterior(points, values, noise=1e-3)
    around = np.vstack([points, points + 0.5])
    one, two = (process.sample(seed=seed, domain=around) for seed in (0, 1))
    for each in (one, two):
        np.testing.assert_allclose(each(points) - points, values, atol=6e-3)
    assert np.abs(one(points + 0.5) - two(points + 0.5)).max() > 0.05
    np.testing.assert_array_equal(process.sample(seed=0, domain=around)(points), one(points))


def test_draws_have_the_covariance_of_the_process(kernel, seen):
    points, values = seen
    free = pl.GaussianProcess(kernel)
    for process, places in ((free, points[:3]), (free.posterior(points, values, noise=0.1), points[:2] + 0.3)):
        drawn = np.array([process.draw(places, seed=seed).reshape(-1) for seed in range(3000)])
        expected = process.covariance(places).reshape(drawn.shape[1], -1)
        assert np.linalg.norm(np.cov(drawn.T) - expected) < 0.12 * np.linalg.norm(expected)
        spread = np.sqrt(np.diag(expected).max())
        np.testing.assert_allclose(drawn.mean(axis=0).reshape(-1, 3), process.mean(places), atol=0.1 * spread)


def test_draws_of_one_seed_change_gradually_with_the_kernel(seen):
    points = np.random.default_rng(5).normal(size=(80, 3))

    def drawn(sigma):
        return pl.GaussianProcess(pl.GaussianKernel(sigma=sigma, scale=1.0)).draw(points, seed=3)

    near, far = (np.linalg.norm(drawn(sigma) - drawn(1.0)) for sigma in (1.001, 3.0))
    assert near < 0.01 * far


def test_samples_and_means_are_maps_of_space(kernel, seen):
    points, values = seen
    places = np.random.default_rng(3).normal(size=(60, 3))
    process = pl.GaussianProcess(kernel).posterior(points, 0.3 * values, noise=0.05)
    sample = process.sample(seed=0, rank=20, tolerance=0.05, domain=points)
    check_deformer(sample, places, rest_image=places + process.mean(places))
    free = pl.GaussianProcess(kernel).sample(seed=0, domain=places[:12], rank=40, tolerance=0.05)
    check_deformer(free, places)


def test_fields_lie_around_a_prior(seen):
    points, values = seen
    prior = pl.Twist(axis="z", angle=0.5, bounds=(-1, 1))
    process = pl.GaussianProcess(SCALAR, prior).posterior(points, values, noise=1e-3)
    np.testing.assert_allclose(process.mean(points), values, atol=1e-3)
    far = np.array([[60.0, 0, 0.3]])
    np.testing.assert_allclose(process.deformer()(far), prior(far), atol=1e-6)
    sample = process.sample(seed=1, domain=points, rank=5, tolerance=0.3)
    places = points + 0.3
    check_deformer(sample, places, rest_image=places + process.mean(places))


def test_what_cannot_be_observed_is_refused():
    process = pl.GaussianProcess(SCALAR)
    with pytest.raises(InvalidParameter, match="nothing was observed"):
        process.sample()
    with pytest.raises(InvalidParameter, match="1 points have 2 displacements"):
        process.posterior(np.zeros((1, 3)), np.zeros((2, 3)), noise=1)
    with pytest.raises(InvalidParameter, match="noise is 0"):
        process.posterior(np.zeros((1, 3)), np.zeros((1, 3)), noise=0)
    np.testing.assert_array_equal(process.mean(np.ones((2, 3))), np.zeros((2, 3)))
