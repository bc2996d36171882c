"""Shape models against the dense formulas of Gaussian processes, and against themselves."""

import numpy as np
import pytest

import pliant as pl
from pliant.errors import InvalidControls, InvalidMesh, InvalidParameter, InvalidTarget, PliantWarning
from pliant.shape.bspline_kernel import BSplineKernel
from pliant.shape.kernels import ExponentialKernel, GaussianKernel
from pliant.shape.matrix_kernels import DiagonalKernel, DirectedKernel
from pliant.shape.model import ShapeModel
from pliant.shape.posterior import along_and_across
from pliant.testing import check_deformer

KERNEL = GaussianKernel(1.5, 0.3) + BSplineKernel(3.0, 0.1)
MATRIX = GaussianKernel(1.5, 0.3) + DirectedKernel(GaussianKernel(1.0, 0.2), [[2, 1, 0], [1, 3, 0], [0, 0, 0.1]])


def dense(kernel, points):
    full = kernel if not kernel.scalar else DiagonalKernel(kernel, kernel, kernel)
    return full(points, points).reshape(3 * len(points), -1)


def spread_of(model):
    columns = model.basis.columns().reshape(3 * len(model.mean), -1)
    return columns @ columns.T


@pytest.fixture
def model(box_mesh):
    return ShapeModel.from_kernel(box_mesh, KERNEL, tolerance=1e-4)


@pytest.fixture
def full(box_mesh):
    return ShapeModel.from_kernel(box_mesh, MATRIX, tolerance=1e-4)


@pytest.fixture(params=["scalar", "matrix"])
def either(request, model, full):
    return model if request.param == "scalar" else full


@pytest.mark.parametrize("kernel", [KERNEL, MATRIX], ids=["scalar", "matrix"])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-5])
def test_pivoted_cholesky_misses_no_more_than_the_tolerance(box_mesh, kernel, tolerance):
    model = ShapeModel.from_kernel(box_mesh, kernel, tolerance=tolerance)
    covariance = dense(kernel, box_mesh.points)
    missing = np.trace(covariance - spread_of(model)) / np.trace(covariance)
    assert missing <= tolerance * (1 + 1e-6)
    assert model.process.kept == pytest.approx(1 - missing, abs=1e-12)
    fewer = ShapeModel.from_kernel(box_mesh, kernel, rank=model.rank - 1)
    assert np.trace(covariance - spread_of(fewer)) / np.trace(covariance) > tolerance
    np.testing.assert_allclose(model.process.at(box_mesh.points).columns(), model.basis.columns(), atol=1e-9)


def test_eigenvalues_are_those_of_the_covariance(model, full):
    for each in (model, full):
        kernel = each.process.kernel
        exact = np.linalg.eigvalsh(dense(kernel, each.mean))[::-1]
        got = np.repeat(each.variances, 3) if each.basis.scalar else each.variances
        np.testing.assert_allclose(got[:20], exact[:20], rtol=2e-3)
        columns = each.basis.columns().reshape(3 * len(each.mean), -1)
        np.testing.assert_allclose(columns.T @ columns, np.diag(got), atol=1e-9 * got[0])


def test_nystrom_is_exact_at_all_points_and_its_eigenvalues_do_not_grow(box_mesh):
    points = box_mesh.points[::2]
    cloud = pl.PolygonMesh(points)
    model = ShapeModel.from_kernel(cloud, KERNEL, tolerance=1e-12, method="nystrom", spread="random", samples=10**6)
    np.testing.assert_allclose(spread_of(model), dense(KERNEL, points), atol=1e-9)
    few, many = (
        ShapeModel.from_kernel(box_mesh, KERNEL, rank=10, method="nystrom", samples=n).variances[:5] for n in (300, 900)
    )
    np.testing.assert_allclose(few, many, rtol=0.04)
    assert many[0] < KERNEL.diagonal(points).max()
    for spread in ("farthest", "area"):
        kept = ShapeModel.from_kernel(box_mesh, KERNEL, rank=30, method="nystrom", spread=spread, samples=100)
        assert np.trace(spread_of(kept)) > 0.9 * np.trace(dense(KERNEL, box_mesh.points))


def test_samples_have_the_covariance(either):
    shapes = either.sample(20_000, seed=3) - either.mean
    ids = [0, 40, 90]
    seen = np.cov(shapes[:, ids].reshape(len(shapes), -1).T)
    np.testing.assert_allclose(seen, either.covariance(ids).reshape(9, 9), atol=0.012)
    np.testing.assert_array_equal(either.sample(5, seed=1), either.sample(5, seed=1))
    single = either.sample(5, seed=1, dtype=np.float32)
    assert single.dtype == np.float32
    np.testing.assert_allclose(single, either.sample(5, seed=1), atol=1e-5)


def test_instances_and_coefficients_undo_each_other(either):
    model = either.truncated(12)
    given = np.random.default_rng(0).normal(size=(4, model.count))
    shapes = model.instance(given)
    np.testing.assert_allclose(shapes[1], model.instance(given[1]), atol=1e-13)
    np.testing.assert_allclose(model.coefficients(shapes[2]), given[2], atol=1e-6)
    np.testing.assert_allclose(model.project(shapes[2]), shapes[2], atol=1e-10)
    noisy = shapes[2] + np.random.default_rng(1).normal(size=shapes[2].shape)
    twice = model.project(model.project(noisy))
    np.testing.assert_allclose(twice, model.project(noisy), atol=1e-9)
    left = (noisy - twice).reshape(-1) @ model.basis.columns().reshape(noisy.size, -1)
    assert np.abs(left).max() < 1e-8  # what is left over is orthogonal to the model
    assert model.logpdf(shapes[2]) == pytest.approx(
        -0.5 * (given[2] ** 2).sum() - model.count / 2 * np.log(2 * np.pi), rel=1e-6
    )


NOISES = {
    "one": 0.05,
    "each": np.linspace(0.01, 0.2, 7),
    "directed": along_and_across(np.eye(3)[[0, 1, 2, 0, 1, 2, 0]], 0.01, 0.5),
}


@pytest.mark.parametrize("name", NOISES)
def test_posteriors_are_those_of_the_dense_formula(either, name, random):
    ids, noise = np.array([0, 20, 33, 60, 99, 120, 149]), NOISES[name]
    positions = either.mean[ids] + random.normal(size=(7, 3)) * 0.2
    model = either.posterior(ids, positions, noise=noise)
    covariance = spread_of(either)
    rows = (3 * ids[:, None] + np.arange(3)).reshape(-1)
    if np.ndim(noise) == 3:
        error = np.zeros((21, 21))
        for i, each in enumerate(noise):
            error[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = each
    else:
        error = np.diag(np.repeat(np.broadcast_to(noise, 7), 3) ** 2.0)
    inner = covariance[np.ix_(rows, rows)] + error
    gain = np.linalg.solve(inner, covariance[rows]).T
    residual = (positions - either.mean[ids]).reshape(-1)
    expected = either.mean + (gain @ residual).reshape(-1, 3)
    np.testing.assert_allclose(model.mean, expected, atol=1e-8)
    np.testing.assert_allclose(either.posterior_mean(ids, positions, noise=noise), expected, atol=1e-8)
    np.testing.assert_allclose(spread_of(model), covariance - gain @ covariance[rows], atol=1e-8)
    assert (np.diff(model.variances) <= 1e-15).all()
    _, logarithm = np.linalg.slogdet(inner)
    density = -0.5 * (residual @ np.linalg.solve(inner, residual) + logarithm + 21 * np.log(2 * np.pi))
    assert either.log_likelihood(ids, positions, noise=noise) == pytest.approx(density, rel=1e-7)
    np.testing.assert_allclose(
        model.uncertainty**2, np.diagonal(spread_of(model)).reshape(-1, 3).sum(axis=1), atol=1e-9
    )


@pytest.mark.parametrize("name", NOISES)
def test_two_posteriors_in_turn_are_one_of_both(either, name, random):
    ids, noise = np.array([0, 20, 33, 60, 99, 120, 149]), NOISES[name]
    noise = np.broadcast_to(noise, (7,)) if np.ndim(noise) < 2 else noise
    positions = either.mean[ids] + random.normal(size=(7, 3)) * 0.2
    together = either.posterior(ids, positions, noise=noise)
    first = either.posterior(ids[:4], positions[:4], noise=noise[:4])
    after = first.posterior(ids[4:], positions[4:], noise=noise[4:])
    np.testing.assert_allclose(after.mean, together.mean, atol=1e-8)
    np.testing.assert_allclose(spread_of(after), spread_of(together), atol=1e-8)
    np.testing.assert_allclose(
        after.process.at(after.reference.points).columns() @ np.eye(after.count), after.basis.columns(), atol=1e-7
    )


def test_free_points_of_the_surface_are_observed_as_vertices_are(either, random):
    ids = np.array([5, 60, 111])
    positions = either.mean[ids] + 0.1 * random.normal(size=(3, 3))
    at_vertices = either.posterior(ids, positions, noise=0.01)
    learnt = ShapeModel(either.reference, either.mean, either.basis)
    for model in (either, learnt):
        free = model.posterior(either.reference.points[ids], positions, noise=0.01)
        np.testing.assert_allclose(free.mean, at_vertices.mean, atol=1e-8)
    corners = either.reference.triangles[7]
    middle = learnt.posterior(either.mean[corners].mean(axis=0)[None], [[9.0, 9, 9]], noise=1e-5)
    np.testing.assert_allclose(middle.mean[corners].mean(axis=0), [9, 9, 9], atol=1e-3)


def test_a_marginal_has_the_covariance_of_its_points(either):
    ids = np.array([0, 1, 5, 6, 30])
    part = either.marginal(ids)
    assert len(part.reference.faces) == 1
    np.testing.assert_allclose(spread_of(part), either.covariance(ids).reshape(15, 15), atol=1e-12)
    np.testing.assert_array_equal(part.mean, either.mean[ids])


def test_a_truncated_model_keeps_the_largest_eigenvalues(either):
    few = either.truncated(5)
    np.testing.assert_allclose(few.variances, either.variances[:5])
    np.testing.assert_allclose(few.basis.columns(), either.basis.columns()[:, :, : few.count])
    np.testing.assert_allclose(few.process.at(few.mean).columns(), few.basis.columns(), atol=1e-9)


def test_a_transformed_model_has_transformed_shapes(either, random):
    matrix = np.hstack([random.normal(size=(3, 3)), random.normal(size=(3, 1))])
    given = random.normal(size=either.count)
    moved = either.transformed(matrix)
    np.testing.assert_allclose(
        moved.instance(given), either.instance(given) @ matrix[:, :3].T + matrix[:, 3], atol=1e-10
    )


def test_a_model_on_another_mesh_has_the_same_fields(either):
    low, high = either.reference.bounds
    other = pl.PolygonMesh(low + (high - low) * np.random.default_rng(0).random((20, 3)))
    moved = either.resampled(other)
    kernel = either.process.kernel
    np.testing.assert_allclose(spread_of(moved), dense(kernel, other.points), atol=0.03)
    part = either.reference.replace(points=either.reference.points)
    learnt = ShapeModel(either.reference, either.mean, either.basis)
    np.testing.assert_allclose(learnt.resampled(part).basis.columns(), either.basis.columns(), atol=1e-12)


def test_an_augmented_model_has_the_sum_of_the_covariances(either):
    more = either.augmented(ExponentialKernel(1.0, 0.1), tolerance=1e-9)
    expected = spread_of(either) + dense(ExponentialKernel(1.0, 0.1), either.mean)
    np.testing.assert_allclose(spread_of(more), expected, atol=1e-6)


def test_another_reference_keeps_the_shapes(model):
    moved = model.with_reference(model.reference.with_points(model.reference.points + 1.0))
    given = np.ones(model.count)
    np.testing.assert_array_equal(moved.instance(given), model.instance(given))
    again = moved.deformer(given)(moved.reference)
    np.testing.assert_allclose(again.points, model.instance(given), atol=1e-12)


@pytest.mark.parametrize("kind", ["prior", "posterior", "directed"])
def test_models_with_a_kernel_are_maps_of_space(either, kind, random):
    model = either.truncated(8)
    if kind != "prior":
        noise = 0.1 if kind == "posterior" else along_and_across(np.eye(3), 0.05, 0.5)
        model = model.posterior([0, 50, 120], model.mean[[0, 50, 120]] + 0.1, noise=noise)
    deformer = model.deformer(0.5 * random.normal(size=model.count))
    points = model.reference.points[::3] + 0.05
    rest = points + model.process.mean(points)
    check_deformer(deformer, points, rest_image=rest)
    np.testing.assert_allclose(deformer(model.reference).points, model.instance(deformer.controls), atol=1e-9)


def test_models_without_a_kernel_move_their_own_mesh(either, random):
    learnt = ShapeModel(either.reference, either.mean + 0.1, either.basis)
    deformer = learnt.deformer(0.3 * random.normal(size=learnt.count))
    check_deformer(deformer, learnt.reference, rest_image=learnt.mean)
    with pytest.raises(InvalidTarget, match="interpolation='surface'"):
        deformer.bind(learnt.mean[:5])
    for kind in ("nearest", "surface"):
        free = learnt.deformer(deformer.controls, interpolation=kind)
        check_deformer(free, learnt.reference, rest_image=learnt.mean)
        np.testing.assert_allclose(free(learnt.reference.points[3:4]), learnt.instance(free.controls)[3:4], atol=1e-12)


def test_point_clouds_and_lines_are_shapes_too():
    t = np.linspace(0, 1, 30)
    points = np.stack([t, t**2, 0 * t], axis=1)
    for mesh in (pl.PolygonMesh(points), pl.PolygonMesh(points, lines=[range(30)])):
        model = ShapeModel.from_kernel(mesh, GaussianKernel(0.3, 0.1), tolerance=1e-6)
        found = model.posterior(points[[4]] + 1e-6, [[1.0, 1, 1]], noise=1e-3)
        np.testing.assert_allclose(found.mean[4], 1, atol=0.01)
    part = model.marginal(np.arange(0, 30))
    assert part.reference.lines is not None


@pytest.mark.parametrize(
    ("make", "kind", "words"),
    [
        (lambda m: m.posterior([150], [[0, 0, 0]], noise=1), InvalidParameter, "vertex 150 is not in the model"),
        (lambda m: m.posterior([-1], [[0, 0, 0]], noise=1), InvalidParameter, "vertex -1"),
        (lambda m: m.posterior([0], [[0, 0, 0]], noise=0), InvalidParameter, "noise is 0, a standard deviation"),
        (lambda m: m.posterior([0], [[0, 0, 0]], noise=[1, 2]), InvalidParameter, "noise has shape"),
        (lambda m: m.posterior([0], [[0, 0, 0]], noise=-np.eye(3)), InvalidParameter, "positive definite"),
        (lambda m: m.posterior([0], [[0, 0, 0], [1, 1, 1]], noise=1), InvalidParameter, "observed at 2 positions"),
        (lambda m: m.posterior([0], [[0, 0, np.nan]], noise=1), InvalidMesh, "not finite"),
        (lambda m: m.posterior([0.5], [[0, 0, 0]], noise=1), InvalidParameter, "indices or"),
        (lambda m: m.instance(np.zeros(2)), InvalidControls, "shape"),
        (lambda m: m.coefficients(m.mean[:4]), InvalidMesh, "do not correspond"),
        (lambda m: m.truncated(0), InvalidParameter, "cannot be cut to 0"),
        (lambda m: m.marginal([1, 1]), InvalidParameter, "twice"),
        (lambda m: m.transformed(np.eye(3)), InvalidParameter, "affine"),
        (lambda m: m.deformer(np.zeros(1)), InvalidControls, "shape"),
        (
            lambda m: m.deformer(interpolation="far")(m.reference),
            InvalidParameter,
            "'nearest', 'surface' or 'tetrahedra'",
        ),
        (lambda m: ShapeModel(m.reference, m.mean[:5], m.basis), InvalidMesh, "all must have the same"),
        (lambda m: ShapeModel.from_kernel(m.reference, KERNEL), InvalidParameter, "rank=, or tolerance="),
        (lambda m: ShapeModel.from_kernel(m.reference, KERNEL, rank=0), InvalidParameter, "at least one"),
        (lambda m: ShapeModel.from_kernel(m.reference, KERNEL, rank=3, method="svd"), InvalidParameter, "'svd'"),
        (lambda m: ShapeModel.from_kernel(pl.PolygonMesh(np.empty((0, 3))), KERNEL, rank=3), InvalidMesh, "no shape"),
    ],
)
def test_what_cannot_be_is_refused_by_name(model, make, kind, words):
    with pytest.raises(kind, match=words):
        make(model)


def test_contradictions_and_short_kernels_are_told(model):
    with pytest.warns(PliantWarning, match=r"observations 0 and 2 are of one place, but 1.73 apart"):
        model.posterior([3, 4, 3], [[0, 0, 0], [0, 0, 0], [1, 1, 1]], noise=0.01)
    with pytest.warns(PliantWarning, match=r"5 fields hold \d+ % of the variance"):
        ShapeModel.from_kernel(model.reference, GaussianKernel(1e-3), rank=5)


def test_repeated_observations_are_a_better_one(model):
    once = model.posterior([3], [[1.0, 1, 1]], noise=0.1 / np.sqrt(2))
    twice = model.posterior([3, 3], [[1.0, 1, 1]] * 2, noise=0.1)
    np.testing.assert_allclose(twice.mean, once.mean, atol=1e-10)
