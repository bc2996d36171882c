"""Isolines, loops and contour-mean skeletons of shapes whose skeletons are known."""

from __future__ import annotations

import numpy as np
import pytest
from surface_shapes import sheet, tube, two_legs

import pliant as pl
from pliant.errors import InvalidParameter, InvalidTarget
from pliant.surface.contour_skeletons import known_skeleton
from pliant.surface.isolines import isolines


def test_two_legs_are_two_loops_at_each_level():
    mesh = two_legs()
    lines = isolines(mesh.triangles, mesh.points[:, 2], np.array([1.01, 2.02, 3.03]))
    assert lines.closed.all()
    assert np.bincount(lines.level).tolist() == [2, 2, 2]
    for loop in range(6):
        x = mesh.points[lines.edges[lines.loops == loop].ravel(), 0]
        assert (x < 1.5).all() or (x > 1.5).all()


def test_a_loop_that_ends_at_the_boundary_is_open():
    mesh = sheet()
    lines = isolines(mesh.triangles, mesh.points[:, 0], np.array([3.5, 4.0, 100.0]))
    assert not lines.closed.any()
    assert lines.level.tolist() == [0, 1]  # a level through vertices is cut once; one beyond the values never


def test_the_skeleton_of_a_tube_is_its_axis():
    mesh = tube(60, 16)
    skeleton = pl.contour_skeleton(mesh, contours=20)
    order = np.argsort(skeleton.points[:, 2])
    assert len(skeleton.points) == 20
    assert np.abs(skeleton.points[:, :2]).max() < 1e-3
    expected = {tuple(sorted(pair)) for pair in zip(order[:-1].tolist(), order[1:].tolist(), strict=True)}
    assert {tuple(sorted(link)) for link in skeleton.links.tolist()} == expected
    means = np.array([mesh.points[skeleton.groups == g, 2].mean() for g in range(20)])
    assert np.abs(means - skeleton.points[:, 2]).max() < 0.25


def test_a_tree_of_two_components_has_one_link_less_than_points_in_each():
    skeleton = pl.contour_skeleton(two_legs(), contours=10, scalar="z")
    assert len(skeleton.links) == len(skeleton.points) - 2
    assert skeleton.carried.shape == two_legs().points.shape


def test_groups_follow_any_scalar():
    mesh = tube(40, 12)
    skeleton = pl.contour_skeleton(mesh, contours=7, scalar=mesh.points[:, 2])
    spans = [np.ptp(mesh.points[skeleton.groups == group, 2]) for group in range(len(skeleton.points))]
    assert len(spans) == 7
    assert max(spans) < 2 * 4.2 / 8
    assert np.array_equal(pl.contour_skeleton(mesh, 7, "z").groups, skeleton.groups)


def test_it_goes_along_with_the_mesh():
    mesh = two_legs()
    skeleton = pl.contour_skeleton(mesh, contours=8)
    moved = np.where(mesh.points[:, :1] > 2, [[0.3, 0, 0.1]], 0.0)  # one leg is shifted, the other stays
    there = skeleton.points[:, 0] > 1.5
    np.testing.assert_allclose(skeleton.following(moved), skeleton.points + there[:, None] * [0.3, 0, 0.1], atol=1e-12)
    matrix = np.array([[1, 0.2, 0], [0, 1, 0.5], [0, 0, 2.0]])
    means = [(mesh.points[skeleton.groups == g] @ (matrix - np.eye(3)).T).mean(axis=0) for g in range(len(there))]
    np.testing.assert_allclose(
        skeleton.following(mesh.points @ (matrix - np.eye(3)).T) - skeleton.points, means, atol=1e-12
    )


def test_it_can_be_written_as_lines(tmp_path):
    skeleton = pl.contour_skeleton(tube(), contours=9)
    pl.write(skeleton.as_mesh(), tmp_path / "skeleton.vtp")
    again = pl.read(tmp_path / "skeleton.vtp")
    assert np.allclose(again.points, skeleton.points)
    assert np.array_equal(np.array(list(again.lines)), skeleton.links)


def test_wrong_arguments_are_named():
    mesh = tube()
    with pytest.raises(InvalidTarget, match="needs a mesh"):
        pl.contour_skeleton(mesh.points)
    for arguments, cause in (((0,), "contours is 0"), ((5, "w"), "no scalar"), ((5, [1.0]), "finite numbers")):
        with pytest.raises(InvalidParameter, match=cause):
            pl.contour_skeleton(mesh, *arguments)


def test_a_known_skeleton_is_the_same_one_until_it_is_asked_for_otherwise():
    mesh = tube(30, 12)
    first = known_skeleton(mesh, 9, None, 10)
    fresh = pl.contour_skeleton(mesh, 9, eigenvectors=10)
    assert known_skeleton(mesh, 9, None, 10) is first
    np.testing.assert_array_equal(first.groups, fresh.groups)
    np.testing.assert_allclose(first.points, fresh.points, atol=1e-12)
    assert len(known_skeleton(mesh, 6, None, 10).points) != len(first.points)
    by_height = known_skeleton(mesh, 9, mesh.points[:, 2], 10)
    np.testing.assert_array_equal(by_height.groups, known_skeleton(mesh, 9, "z", 10).groups)
