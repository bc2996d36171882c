"""Kernels: positive semi-definite, with the derivatives that they claim, and algebra that is that of their fields."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pliant as pl
from pliant.errors import InvalidParameter, NotDifferentiable
from pliant.shape.bspline_kernel import BSplineKernel
from pliant.shape.kernel_algebra import Varying, Warped, change_point
from pliant.shape.kernel_text import parse_kernel
from pliant.shape.kernels import (
    ExponentialKernel,
    GaussianKernel,
    InverseMultiquadricKernel,
    MaternKernel,
    RationalQuadraticKernel,
)
from pliant.shape.matrix_kernels import DiagonalKernel, DirectedKernel, SampleCovariance, SymmetricKernel

GAUSS, ROUGH = GaussianKernel(0.7, 2.0), MaternKernel(0.5, 1.5, smoothness=1.5)
KERNELS = {
    "gaussian": GAUSS,
    "exponential": ExponentialKernel(0.7, 2.0),
    "matern 3/2": ROUGH,
    "matern 5/2": MaternKernel(0.5, 1.5),
    "rational quadratic": RationalQuadraticKernel(0.6, 1.0, alpha=0.8),
    "inverse multiquadric": InverseMultiquadricKernel(0.6, 1.0),
    "b-spline": BSplineKernel(1.1, 0.5),
    "multi-scale": BSplineKernel.multi_scale(2.0, 1.0, 3),
    "sum": GAUSS + ROUGH,
    "product": GAUSS * BSplineKernel(2.0),
    "scaled": 0.3 * GAUSS,
    "varying": Varying(
        GAUSS, lambda x: 1 + x[:, 0] ** 2, lambda x: np.stack([2 * x[:, 0], 0 * x[:, 0], 0 * x[:, 0]], 1)
    ),
    "warped": Warped(GAUSS, pl.Twist(axis="z", angle=1.0, bounds=(-1, 1))),
    "change point": change_point(GAUSS, ROUGH, (0, 0.1, 0), (1, 2, 0), 0.3),
    "diagonal": DiagonalKernel(GAUSS, ROUGH, BSplineKernel(1.0)),
    "directed": DirectedKernel(ROUGH, [[2, 1, 0], [1, 3, 0.5], [0, 0.5, 1]]),
    "symmetric": SymmetricKernel(change_point(GAUSS, ROUGH, (0, 0, 0), (1, 1, 0), 0.3), (0.1, 0, 0), (1, 0.3, 0)),
    "antisymmetric": SymmetricKernel(GAUSS, antisymmetric=True),
    "matrix sum": GAUSS + DirectedKernel(ROUGH, np.diag([1.0, 0, 2])),
    "matrix product": GAUSS * DiagonalKernel(GAUSS, ROUGH, ROUGH),
    "matrix varying": Varying(DiagonalKernel(GAUSS, ROUGH, ROUGH), lambda x: x[:, 1], lambda x: 0 * x + [0, 1, 0]),
}


def matrix(kernel, x, y):
    values = kernel(x, y)
    return values if kernel.scalar else values.reshape(3 * len(x), 3 * len(y))


@pytest.mark.parametrize("name", KERNELS)
@given(seed=st.integers(0, 2**31))
@settings(deadline=None, max_examples=8)
def test_every_kernel_is_positive_semidefinite_and_symmetric(name, seed):
    kernel = KERNELS[name]
    x = np.random.default_rng(seed).normal(size=(20, 3))
    covariance = matrix(kernel, x, x)
    assert np.abs(covariance - covariance.T).max() < 1e-13
    assert np.linalg.eigvalsh(covariance).min() > -1e-12 * np.trace(covariance)
    y = x[:7] + 0.3
    assert np.abs(matrix(kernel, x, y) - matrix(kernel, y, x).T).max() < 1e-13


@pytest.mark.parametrize("name", KERNELS)
def test_the_diagonal_is_that_of_the_matrix(name, random):
    kernel, x = KERNELS[name], random.normal(size=(15, 3))
    at = np.arange(15)
    full = kernel(x, x)
    np.testing.assert_allclose(kernel.diagonal(x), full[at, at] if kernel.scalar else full[at, :, at], atol=1e-13)


@pytest.mark.parametrize("name", [name for name in KERNELS if name not in {"exponential"}])
def test_slopes_agree_with_finite_differences(name, random):
    kernel, x, y = KERNELS[name], random.normal(size=(6, 3)), random.normal(size=(5, 3))
    slopes, step = kernel.slopes(x, y), 1e-5
    for axis in range(3):
        h = step * np.eye(3)[axis]
        np.testing.assert_allclose((kernel(x + h, y) - kernel(x - h, y)) / (2 * step), slopes[..., axis], atol=2e-8)


def test_the_exponential_has_slopes_away_from_its_tip(random):
    kernel, x, y = KERNELS["exponential"], random.normal(size=(6, 3)), random.normal(size=(5, 3))
    h = 1e-6 * np.eye(3)[1]
    np.testing.assert_allclose((kernel(x + h, y) - kernel(x - h, y)) / 2e-6, kernel.slopes(x, y)[..., 1], atol=1e-8)
    assert not kernel.slopes(y, y)[0, 0].any()


def test_values_at_one_distance_are_those_of_the_textbooks():
    x, y = np.zeros((1, 3)), np.array([[0, 0, 0.5]])
    r = 0.5 / 0.7
    values = {
        "gaussian": 4 * np.exp(-(r**2)),
        "exponential": 4 * np.exp(-r),
        "matern 3/2": 2.25 * (1 + np.sqrt(3)) * np.exp(-np.sqrt(3)),
        "matern 5/2": 2.25 * (1 + np.sqrt(5) + 5 / 3) * np.exp(-np.sqrt(5)),
        "rational quadratic": (1 + (0.5 / 0.6) ** 2 / 1.6) ** -0.8,
        "inverse multiquadric": 1 / np.sqrt(1 + (0.5 / 0.6) ** 2),
    }
    for name, value in values.items():
        assert KERNELS[name](x, y)[0, 0] == pytest.approx(value, rel=1e-14), name


def test_b_splines_vanish_a_support_apart_and_peak_at_the_nodes(random):
    kernel = BSplineKernel(support=2.0, scale=3.0)
    nodes = 0.5 * random.integers(-9, 9, size=(10, 3))
    np.testing.assert_allclose(kernel.diagonal(nodes), 9.0, rtol=1e-14)
    x = random.normal(size=(50, 3))
    assert kernel.diagonal(x).min() > 0.78 * 9
    assert kernel.diagonal(x).max() <= 9 * (1 + 1e-14)
    assert not kernel(x, x + [0, 2.0, 0]).diagonal().any()


def test_b_splines_are_the_covariance_of_a_random_lattice():
    x, y = np.array([[0.13, -0.4, 0.3]]), np.array([[0.5, 0.1, -0.2]])
    lattice = pl.BSplineFFD.around(np.array([[-4.0] * 3, [4.0] * 3]), shape=(17, 17, 17))
    weights = lattice.bind(np.vstack([x, y])).weights
    rows = weights.T @ np.eye(2)
    assert BSplineKernel(2.0, 1.5)(x, y)[0, 0] == pytest.approx(8 * 1.5**2 * rows[:, 0] @ rows[:, 1], rel=1e-12)


def test_sums_and_products_are_those_of_the_values(random):
    x, y = random.normal(size=(2, 8, 3))
    np.testing.assert_allclose((GAUSS + ROUGH)(x, y), GAUSS(x, y) + ROUGH(x, y))
    np.testing.assert_allclose((GAUSS * ROUGH)(x, y), GAUSS(x, y) * ROUGH(x, y))
    np.testing.assert_allclose((GAUSS * 0.25)(x, y), 0.25 * GAUSS(x, y))
    three = DiagonalKernel(GAUSS, GAUSS, GAUSS)
    np.testing.assert_allclose((three + GAUSS)(x, y), (2.0 * three)(x, y))


def test_a_symmetric_field_is_its_own_mirror_image(random):
    kernel = KERNELS["symmetric"]
    normal = np.array([1, 0.3, 0]) / np.linalg.norm([1, 0.3, 0])
    turn = np.eye(3) - 2 * np.outer(normal, normal)
    x, y = random.normal(size=(2, 9, 3))
    far = [0.1, 0, 0] + (x - [0.1, 0, 0]) @ turn
    np.testing.assert_allclose(kernel(far, y), np.einsum("ij,njmk->nimk", turn, kernel(x, y)), atol=1e-13)


def test_a_sample_covariance_is_that_of_the_samples(random):
    points, fields = random.normal(size=(12, 3)), random.normal(size=(6, 12, 3))
    kernel = SampleCovariance(points, fields)
    np.testing.assert_allclose(matrix(kernel, points, points), np.cov(fields.reshape(6, -1).T), atol=1e-13)
    np.testing.assert_allclose(kernel.diagonal(points + 1e-6), kernel.diagonal(points))
    with pytest.raises(NotDifferentiable, match="no derivative"):
        kernel.slopes(points, points)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: GaussianKernel(0.0), "sigma of a GaussianKernel is 0; it must be above zero"),
        (lambda: ExponentialKernel(1.0, -2.0), "scale of a ExponentialKernel is -2"),
        (lambda: BSplineKernel(np.nan), "support of a BSplineKernel is nan"),
        (lambda: MaternKernel(1.0, smoothness=1.0), "1.5 or 2.5"),
        (lambda: -1.0 * GAUSS, "the factor of a kernel is -1"),
        (lambda: GaussianKernel("wide"), "'wide'; it must be a number"),
        (lambda: DirectedKernel(GAUSS, -np.eye(3)), "eigenvalue -1"),
        (lambda: BSplineKernel.multi_scale(1.0, 1.0, 0), "1 to 20 levels"),
        (lambda: change_point(GAUSS, GAUSS, (0, 0, 0), (0, 0, 0), 1.0), "not all zero"),
        (lambda: DirectedKernel(GAUSS, np.eye(3)) * DirectedKernel(GAUSS, np.eye(3)), "no product"),
        (lambda: SampleCovariance(np.zeros((2, 3)), np.zeros((1, 2, 3))), "at least two"),
    ],
)
def test_what_cannot_be_a_kernel_is_refused_by_name(make, words):
    with pytest.raises(InvalidParameter, match=words):
        make()


def test_whole_numbers_are_numbers(random):
    points = random.normal(size=(20, 3))
    kernel = parse_kernel("gaussian(sigma=3, scale=2) + bspline(4, 1)")
    same = parse_kernel("gaussian(sigma=3.0, scale=2.0) + bspline(4.0, 1.0)")
    np.testing.assert_array_equal(kernel.diagonal(points), same.diagonal(points))
    np.testing.assert_array_equal(kernel(points, points), same(points, points))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("multi_scale(10, 1, levels=1e999)", "whole number of levels"),
        ("multi_scale(10, 1, levels=2.5)", "whole number of levels"),
        (f"multi_scale(10, 1, levels={10**400})", "is no kernel"),
        (f"gaussian(sigma={10**400}, x=1)", "is no kernel"),
        ("+".join(["gaussian(1, 1)"] * 2_000), "is no kernel"),
    ],
)
def test_numbers_and_sums_beyond_reason_are_refused_in_a_line(text, words):
    with pytest.raises(InvalidParameter, match=words) as caught:
        parse_kernel(text)
    assert len(str(caught.value)) < 250


@pytest.mark.parametrize("scale", [1e300, 1e-300, 10**400, -1.0, np.nan, "wide"])
def test_a_scale_whose_square_is_no_number_above_zero_is_refused(scale):
    with pytest.raises(InvalidParameter, match="above zero"):
        pl.GaussianKernel(sigma=1.0, scale=scale)
