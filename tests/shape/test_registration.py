"""Fitting: alignment is exact, closest points are closest, and known shapes are found again."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import pliant as pl
from pliant.errors import InvalidParameter, InvalidTarget, NotConverged
from pliant.numerics.meshes.closest_surface import TriangleSearch
from pliant.shape import robust
from pliant.shape.correspondence import Target, triangle_normals, vertex_normals
from pliant.shape.procrustes import moved


def motion(seed, scale=1.0):
    random = np.random.default_rng(seed)
    matrix = np.eye(4)
    matrix[:3, :3] = scale * Rotation.random(random_state=seed % 2**31).as_matrix()
    matrix[:3, 3] = random.normal(size=3)
    return matrix


@given(seed=st.integers(0, 10**6), scale=st.sampled_from([None, 0.3, 2.0]))
@settings(deadline=None, max_examples=25)
def test_alignment_finds_the_motion(seed, scale):
    points = np.random.default_rng(seed).normal(size=(6, 3))
    matrix = motion(seed, scale or 1.0)
    found = pl.align(points, moved(matrix, points), scale=scale is not None)
    np.testing.assert_allclose(found, matrix, atol=1e-10)


def test_alignment_is_the_best_there_is(random):
    one, two, weights = random.normal(size=(9, 3)), random.normal(size=(9, 3)), random.random(9)
    best = pl.align(one, two, scale=True, weights=weights)

    def error(matrix):
        return (weights * ((moved(matrix, one) - two) ** 2).sum(axis=1)).sum()

    assert np.linalg.det(best[:3, :3]) > 0
    for seed in range(30):
        other = motion(seed, 1.0)
        near = best.copy()
        near[:3, :3] = (
            Rotation.from_matrix(other[:3, :3]).__pow__(1e-2).as_matrix() @ best[:3, :3] * (1 + 1e-2 * (seed % 3 - 1))
        )
        near[:3, 3] += 1e-2 * other[:3, 3]
        assert error(near) >= error(best)


def test_weights_of_zero_leave_points_out(random):
    one, two = random.normal(size=(2, 8, 3))
    weights = np.array([1, 1, 1, 1, 1, 0, 0, 0.0])
    np.testing.assert_allclose(pl.align(one, two, weights=weights), pl.align(one[:5], two[:5]), atol=1e-12)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((np.zeros((3, 3)), np.zeros((3, 3))), "in a line, or at one place"),
        ((np.eye(3)[:2], np.eye(3)[:2]), "at least three"),
        ((np.outer(np.arange(4.0), [1, 2, 3]),) * 2, "in a line"),
    ],
)
def test_points_that_say_nothing_of_a_rotation_are_refused(arguments, words):
    with pytest.raises(InvalidParameter, match=words):
        pl.align(*arguments)


def test_generalized_procrustes_undoes_motions(random):
    base = random.normal(size=(20, 3))
    shapes = np.stack([moved(motion(seed, 1 + 0.1 * seed), base) for seed in range(5)])
    aligned, mean = pl.generalized_procrustes(shapes, scale=True)
    np.testing.assert_allclose(aligned, np.broadcast_to(mean, aligned.shape), atol=1e-9)
    assert np.linalg.norm(mean - mean.mean(axis=0)) == pytest.approx(np.linalg.norm(base - base.mean(axis=0)))
    noisy = shapes + 0.05 * random.normal(size=shapes.shape)
    aligned, mean = pl.generalized_procrustes(noisy)
    np.testing.assert_allclose(pl.align(aligned.mean(axis=0), mean), np.eye(4), atol=1e-8)
    for each in aligned:
        np.testing.assert_allclose(pl.align(each, mean), np.eye(4), atol=1e-8)


def test_closest_points_are_those_of_a_search_over_all_triangles(coarse, random):
    queries = random.normal(size=(200, 3)) * [3, 2, 1]
    search = TriangleSearch(coarse.points, coarse.triangles)
    found = search.query(queries)
    np.testing.assert_allclose(found.weights.sum(axis=1), 1, atol=1e-12)
    assert found.weights.min() > -1e-12
    grid = np.array([[i, j, 40 - i - j] for i in range(41) for j in range(41 - i)]) / 40
    corners = coarse.points[coarse.triangles]
    distance = np.linalg.norm(found.points - queries, axis=1)
    for query, d in zip(queries[:20], distance[:20], strict=True):
        sampled = np.linalg.norm(np.einsum("gc,tcd->tgd", grid, corners) - query, axis=2).min()
        assert d <= sampled + 1e-12
        assert sampled - d < 0.01
    carried = np.einsum("mc,mcd->md", found.weights, corners[found.triangles])
    np.testing.assert_allclose(carried, found.points, atol=1e-12)


def test_long_triangles_are_not_missed():
    points = np.array(
        [[0, 0, 0], [100.0, 0, 0], [0, 0.1, 0], *np.random.default_rng(0).normal(size=(90, 3)) + [60, 9, 0]]
    )
    triangles = np.vstack([[[0, 1, 2]], np.arange(3, 93).reshape(-1, 3)])
    found = TriangleSearch(points, triangles).query(np.array([[60.0, 0, 1]]))
    assert found.triangles[0] == 0
    assert np.linalg.norm(found.points[0] - [60, 0, 1]) == pytest.approx(1.0, abs=1e-3)


def test_normals_are_those_of_the_mesh(coarse):
    np.testing.assert_allclose(vertex_normals(coarse.points, coarse.triangles), coarse.vertex_normals, atol=1e-12)
    outwards = triangle_normals(coarse.points, coarse.triangles)
    assert (np.einsum("ti,ti->t", outwards, coarse.points[coarse.triangles].mean(axis=1)) > 0).all()


@pytest.mark.parametrize("loss", ["squares", "huber", "tukey"])
def test_weights_are_the_slope_of_the_loss_over_the_distance(loss):
    r = np.linspace(0.05, 8, 60)
    slope = (robust.losses(r + 1e-6, loss) - robust.losses(r - 1e-6, loss)) / 2e-6
    np.testing.assert_allclose(robust.weights(r, loss) * r, slope, atol=1e-8)
    assert robust.weights(np.zeros(1), loss)[0] == 1
    with pytest.raises(InvalidParameter, match="'soft'"):
        robust.losses(r, "soft")


def test_a_shape_of_the_model_is_found_on_its_own_mesh(soft):
    given = 0.8 * np.random.default_rng(4).normal(size=soft.count)
    target = soft.reference.with_points(soft.instance(given))
    fitted = soft.fit(target, iterations=60)
    assert fitted.distance < 5e-3  # below the noise of a thousandth of the diagonal
    np.testing.assert_allclose(fitted.points, soft.instance(fitted.coefficients), atol=1e-12)


@pytest.mark.parametrize("pose", ["rigid", "similarity"])
def test_a_moved_shape_of_another_topology_is_found(soft, fine, pose):
    given = 0.5 * np.random.default_rng(1).normal(size=soft.count)
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_rotvec([0.1, 0.2, -0.15]).as_matrix() * (1.3 if pose == "similarity" else 1)
    matrix[:3, 3] = 40, -20, 30
    target = soft.deformer(given)(fine)
    target = target.with_points(moved(matrix, target.points))
    fitted = soft.fit(target, iterations=100, pose=pose)
    assert fitted.distance < 0.01
    np.testing.assert_allclose(fitted.points, moved(fitted.pose, soft.instance(fitted.coefficients)), atol=1e-10)


def test_whoever_watches_a_fit_sees_each_round_and_may_end_it(soft, fine):
    seen = []
    found = soft.fit(fine, iterations=6, pose="rigid", watch=seen.append)
    assert [each.number for each in seen] == list(range(1, found.iterations + 1))
    assert {each.most for each in seen} == {6}
    np.testing.assert_array_equal(seen[-1].coefficients, found.coefficients)
    np.testing.assert_array_equal(seen[-1].pose, found.pose)

    class EnoughError(Exception):
        pass

    def stop(each):
        if each.number == 2:
            raise EnoughError

    with pytest.raises(EnoughError):
        soft.fit(fine, watch=stop)


def test_half_a_target_does_not_pull_the_rest(soft, fine):
    given = 0.5 * np.random.default_rng(2).normal(size=soft.count)
    whole = soft.deformer(given)(fine)
    keep = whole.points[whole.triangles].mean(axis=1)[:, 0] > -0.5
    part = pl.PolygonMesh(whole.points, whole.triangles[keep])
    fitted = soft.fit(part, iterations=60)
    seen = soft.instance(given)[:, 0] > 0
    error = np.abs(Target(whole, np.pi).closest(fitted.points) - fitted.points)
    assert error[seen].max() < 0.05
    assert error.mean() < 0.15
    assert np.abs(fitted.coefficients).max() < 4


def test_far_points_do_not_count(soft):
    given = 0.5 * np.random.default_rng(3).normal(size=soft.count)
    points = soft.instance(given)
    spoilt = points.copy()
    spoilt[100:110] += [0, 0, 1.5]
    fitted = soft.fit(soft.reference.with_points(spoilt), iterations=80, loss="tukey")
    away = np.linalg.norm(
        Target(soft.reference.with_points(points), np.pi).closest(fitted.points) - fitted.points, axis=1
    )
    assert np.median(away) < 0.01


def test_landmarks_help_by_a_posterior(soft):
    given = np.random.default_rng(5).normal(size=soft.count)
    target = soft.reference.with_points(soft.instance(given))
    ids = np.array([0, 100, 200, 300])
    fitted = soft.posterior(ids, target.points[ids], noise=1e-2).fit(target, iterations=60)
    np.testing.assert_allclose(fitted.points[ids], target.points[ids], atol=0.05)
    assert fitted.distance < 5e-3


def test_point_clouds_are_fitted_too(soft):
    given = 0.5 * np.random.default_rng(6).normal(size=soft.count)
    cloud = pl.PolygonMesh(soft.instance(given))
    fitted = soft.fit(cloud, iterations=60)
    np.testing.assert_allclose(fitted.points, cloud.points, atol=0.05)


def test_what_cannot_be_fitted_is_refused_by_name(soft, fine):
    with pytest.raises(InvalidTarget, match="no points"):
        soft.fit(pl.PolygonMesh(np.empty((0, 3))))
    with pytest.raises(InvalidParameter, match="noise is 0"):
        soft.fit(fine, noise=0)
    with pytest.raises(InvalidParameter, match="'free'"):
        soft.fit(fine, pose="free")
    with pytest.raises(NotConverged, match="fewer than three points"):
        soft.fit(pl.PolygonMesh(fine.points, fine.triangles[:, ::-1]))
