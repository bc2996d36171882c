"""Smoothing, regions and transfer: they are no deformers, and have laws of their own."""

from __future__ import annotations

import numpy as np
import pytest
from surface_shapes import rotation, sheet, tube, two_legs

import pliant as pl
from pliant.errors import InvalidParameter, InvalidTarget
from pliant.numerics.meshes.laplacians import normalized, uniform_weights
from pliant.surface import regions
from pliant.surface.screen import in_brush, in_lasso, in_rectangle
from pliant.surface.smoothing import METHODS

MESH = tube(40, 16)


def rough(mesh, size=0.03):
    noise = np.random.default_rng(5).normal(size=(len(mesh.points), 1)) * size
    return mesh.with_points(mesh.points + noise * mesh.vertex_normals)


@pytest.mark.parametrize("method", [name for name in METHODS if name != "delta mush"])
def test_smoothing_commutes_with_motions_and_takes_noise_off(method):
    mesh, turn = rough(MESH), rotation([0.4, 0.9, -0.3])
    smooth = pl.smooth(mesh, 4, method=method)
    turned = pl.smooth(mesh.with_points(mesh.points @ turn.T + 2), 4, method=method)
    assert np.abs(turned.points - smooth.points @ turn.T - 2).max() < 1e-9
    bumps = normalized(uniform_weights(mesh.points, mesh.triangles))
    assert np.linalg.norm(bumps @ smooth.points) < 0.7 * np.linalg.norm(bumps @ mesh.points)
    assert pl.smooth(mesh, 0, method=method).points.tolist() == mesh.points.tolist()


def test_taubin_keeps_the_volume_that_others_lose():
    mesh = rough(MESH)
    kept, lost = (pl.volume(pl.smooth(mesh, 20, method=m)) / pl.volume(MESH) for m in ("taubin", "explicit"))
    assert abs(kept - 1) < 0.05 < 1 - lost


def test_implicit_smoothing_is_stable_at_any_strength():
    low, high = MESH.bounds
    result = pl.smooth(rough(MESH), 3, strength=1e6)
    assert (result.points > low - 0.1).all()
    assert (result.points < high + 0.1).all()


def test_smoothing_within_leaves_the_rest_alone():
    within = np.flatnonzero(MESH.points[:, 2] > 2)
    result = pl.smooth(rough(MESH), 3, within=within).points
    outside = np.setdiff1d(np.arange(len(MESH.points)), within)
    assert np.array_equal(result[outside], rough(MESH).points[outside])


def test_delta_mush_gives_a_rigid_pose_back_exactly():
    mesh, turn = rough(MESH), rotation([0, 1.1, 0.2])
    posed = mesh.with_points(mesh.points @ turn.T + 1.0)
    assert np.abs(pl.smooth(posed, 8, method="delta mush", rest=mesh).points - posed.points).max() < 1e-9


def test_wrong_smoothing_is_refused():
    for options, cause in (
        ({"method": "hard"}, "no method"), ({"strength": -1}, "strength is -1"), ({"iterations": -1}, "iterations"),
        ({"method": "taubin", "strength": 3}, "not stable"), ({"method": "delta mush"}, "needs rest"),
        ({"weights": "mean value"}, "knows no weights"), ({"rest": MESH}, "only that"),
        ({"method": "delta mush", "rest": sheet()}, "another mesh"),
    ):  # fmt: skip
        with pytest.raises(InvalidParameter, match=cause):
            pl.smooth(MESH, **options)


def test_regions_in_space_and_along_the_surface():
    mesh = two_legs()
    ball = regions.sphere(mesh, [0, 0, 2], 0.7)
    assert np.array_equal(ball, np.flatnonzero(np.linalg.norm(mesh.points - [0, 0, 2], axis=1) <= 0.7))
    near = regions.geodesic_ball(mesh, [0], 5.0)
    assert (mesh.points[near, 0] < 2).all()  # the other leg is near in space, and no path leads there
    assert np.isin(ball, regions.grow(mesh, ball)).all()
    assert np.isin(regions.shrink(mesh, ball), ball).all()
    ring = regions.belt(mesh, ball, 2)
    assert np.array_equal(np.union1d(ring, ball), regions.grow(mesh, ball, 2))
    assert np.array_equal(regions.shrink(mesh, ball, -2), regions.grow(mesh, ball, 2))
    assert np.array_equal(regions.grow(mesh, np.arange(0), 3), [])
    with pytest.raises(InvalidParameter, match="radius is positive"):
        regions.sphere(mesh, [0, 0, 0], -1)
    with pytest.raises(InvalidParameter, match="no vertex to measure from"):
        regions.geodesic_ball(mesh, [], 1.0)


def test_what_a_rectangle_sees_is_in_front():
    camera = np.array([[0.2, 0, 0, 0], [0, 0, 0.2, -0.4], [0, 0.2, 0, 0], [0, 0, 0, 1.0]])  # from -y, straight on
    mesh = tube(60, 40)
    both = in_rectangle(mesh, camera, [-0.5, -0.2], [0.5, 0.2])
    assert np.array_equal(both, np.flatnonzero(np.abs(mesh.points[:, 2] - 2) < 1.0))
    seen = in_rectangle(mesh, camera, [0.5, 0.2], [-0.5, -0.2], visible=True)
    assert np.isin(seen, both).all()
    assert (mesh.points[seen, 1] < 0.05).all()
    assert np.isin(both[mesh.points[both, 1] < -0.05], seen).all()
    half = in_lasso(mesh, camera, [(0, -0.2), (0.5, -0.2), (0.5, 0.2), (0, 0.2)])
    assert np.array_equal(half, both[mesh.points[both, 0] >= 0])
    with pytest.raises(InvalidParameter, match="camera"):
        in_rectangle(mesh, np.eye(3), [0, 0], [1, 1])


def test_a_perspective_camera_sees_nothing_behind_it():
    camera = np.array([[1, 0, 0, 0], [0, 0, 1, -2], [0, 1, 0, -0.2], [0, 1, 0, 0.0]])  # at (0, 0, 2), looking along y
    mesh = tube(60, 40)
    found = in_rectangle(mesh, camera, [-9, -9], [9, 9])
    assert (mesh.points[found, 1] > 0).all()
    assert len(found)


def test_a_brush_paints_what_its_stroke_passes():
    camera = np.array([[0.2, 0, 0, 0], [0, 0, 0.4, -0.8], [0, 0.2, 0, 0], [0, 0, 0, 1.0]])  # from -y; twice as high
    mesh = tube(60, 40)
    across = mesh.points[:, [0, 2]]
    dab = in_brush(mesh, camera, [(0.0, 0.0)], (0.06, 0.12))  # a circle of 0.3 around (0, 2)
    assert np.array_equal(dab, np.flatnonzero(np.linalg.norm(across - [0, 2], axis=1) < 0.3))
    stroke = in_brush(mesh, camera, [(0.0, -0.4), (0.0, 0.0), (0.0, 0.4)], (0.06, 0.12))
    way = np.abs(across[:, 0]) < np.sqrt(np.maximum(0.09 - np.maximum(np.abs(across[:, 1] - 2) - 1, 0) ** 2, 0))
    assert np.array_equal(stroke, np.flatnonzero(way))
    seen = in_brush(mesh, camera, [(0.0, 0.0)], (0.06, 0.12), visible=True)
    assert np.isin(seen, dab).all()
    assert (mesh.points[seen, 1] < 0.05).all()
    assert len(seen) < len(dab)
    for path, radius, cause in (([], (1, 1), "path"), ([(0, 0)], (0, 1), "positive"), ([(0, 0)], 1, "two")):
        with pytest.raises(InvalidParameter, match=cause):
            in_brush(mesh, camera, path, radius)


def pairs_between(one, two, count=40):
    """Markers of tubes of different resolution: the same heights and angles."""
    chosen = np.random.default_rng(0).choice(len(one.points) - 2, count, replace=False)
    away = np.linalg.norm(one.points[chosen][:, None] - two.points[None], axis=2)
    return np.column_stack([chosen, away.argmin(axis=1)])


@pytest.fixture(scope="module")
def clone():
    source, target = tube(30, 14), tube(45, 20, bumps=0.05)
    return pl.DeformationTransfer(source, target, pairs_between(source, target))


def test_transfer_is_exact_at_rest_and_for_similarities_and_near_for_linear_maps(clone):
    assert np.abs(clone.points(clone.source.points) - clone.target.points).max() < 1e-14
    matrix = np.array([[1.2, 0.3, 0], [-0.1, 0.9, 0.2], [0.4, 0.2, 1]])
    turn = rotation([0.5, -0.8, 0.4])
    for linear, tolerance in ((turn, 1e-8), (1.7 * turn, 1e-8), (matrix, 5e-3)):
        result = clone.points(clone.source.points @ linear.T + [1, 2, 3])
        centered = result - result.mean(axis=0)
        expected = (clone.target.points - clone.target.points.mean(axis=0)) @ linear.T
        assert np.abs(centered - expected).max() < tolerance * 10


def test_transfer_bends_the_target_as_the_source_was_bent(clone):
    def bend(points):
        angle = 0.25 * points[:, 2]
        return np.column_stack(
            [points[:, 0] * np.cos(angle) + 4 * (1 - np.cos(angle)), points[:, 1],
             (4 - points[:, 0]) * np.sin(angle)]
        )  # fmt: skip

    result, expected = clone.points(bend(clone.source.points)), bend(clone.target.points)
    offset = (result - expected).mean(axis=0)
    assert np.abs(result - expected - offset).max() < 0.15
    assert np.abs(offset).max() < 0.2


def test_a_correspondence_can_be_saved(clone, tmp_path):
    pl.write_pairs(clone.correspondence, tmp_path / "pairs.txt")
    again = pl.DeformationTransfer(
        clone.source, clone.target, clone.markers, correspondence=pl.read_pairs(tmp_path / "pairs.txt")
    )
    pose = clone.source.points * [1.0, 1.3, 0.8]
    assert np.array_equal(again.points(pose), clone.points(pose))
    assert np.array_equal(np.unique(clone.correspondence[:, 1]), np.arange(len(clone.target.triangles)))


def test_a_pose_of_another_mesh_is_refused(clone):
    with pytest.raises(InvalidTarget, match="the source has 422"):
        clone(sheet())
    with pytest.raises(InvalidParameter, match="other meshes"):
        pl.DeformationTransfer(clone.source, clone.target, clone.markers, correspondence=[[0, 10**6]])
    with pytest.raises(InvalidParameter, match="leaves"):
        pl.DeformationTransfer(clone.source, clone.target, clone.markers, correspondence=[[0, 0]])
