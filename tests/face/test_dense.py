"""Subdivision reproduces what it must, and the dense face passes near landmarks that it has not seen."""

from __future__ import annotations

import numpy as np
import pytest

import pliant as pl
from pliant.errors import InvalidParameter
from pliant.face.dense import difference, subdivided_mean
from pliant.face.subdivision import Subdivision
from pliant.face.topology import boundary_loops, mean_face


def grid(count):
    """A regular triangle grid: every inner vertex has six neighbours."""
    i, j = np.meshgrid(np.arange(count), np.arange(count), indexing="ij")
    points = np.stack([i + 0.5 * j, np.sqrt(3) / 2 * j, 0.0 * i], axis=-1).reshape(-1, 3)

    def at(a, b):
        return (count * a + b)[:-1, :-1].ravel()

    a, b, c, d = at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)
    return points, np.vstack([np.column_stack([a, b, c]), np.column_stack([b, d, c])])


def test_weights_sum_to_one_and_counts_follow_euler():
    mesh = mean_face()
    for levels, count in ((1, 1790), (2, 6990)):
        finer = Subdivision.of(mesh.triangles, 468, levels)
        assert finer.weights.shape == (count, 468)
        assert np.allclose(finer.weights.sum(axis=1), 1)
        assert finer.weights.data.min() >= 0
        assert len(finer.triangles) == 852 * 4**levels
        dense = pl.PolygonMesh(finer.weights @ mesh.points, finer.triangles)
        assert dense.edge_use == (88 * 2**levels, 0)
        assert len(dense.points) - len(dense.edges) + len(dense.faces) == -2


def test_linear_functions_are_reproduced_inside_and_along_straight_borders():
    points, triangles = grid(9)
    finer = Subdivision.of(triangles, len(points), 2)
    fine = finer.weights @ points
    inner = points[(abs(points - points.mean(axis=0)) < [2.2, 1.8, 1]).all(axis=1)]
    near = np.linalg.norm(fine[:, None] - inner[None], axis=2).min(axis=1) < 1e-12
    assert near.sum() >= len(inner)  # regular grid points stay where they are
    values = points @ [2.0, -3.0, 0.0] + 1
    assert np.allclose(finer.weights @ values, fine @ [2.0, -3.0, 0.0] + 1, atol=1e-12)


def test_a_regular_grid_is_the_quartic_box_spline():
    _points, triangles = grid(7)
    middle = 3 * 7 + 3
    mask = Subdivision.of(triangles, 49, 1).weights[:, [middle]].toarray().ravel()
    assert mask[middle] == pytest.approx(10 / 16)
    values = np.sort(mask[mask > 0])
    assert np.allclose(values, np.sort([10 / 16] + [1 / 16] * 6 + [6 / 16] * 6 + [2 / 16] * 6))


def test_borders_are_cubic_b_splines_of_their_own():
    points, triangles = grid(6)
    lifted = points.copy()
    border = np.unique(np.concatenate(boundary_loops(triangles)))
    inner = np.setdiff1d(np.arange(36), border)
    lifted[inner, 2] = np.random.default_rng(1).normal(size=len(inner))
    fine = Subdivision.of(triangles, 36, 1)
    loop = np.concatenate(boundary_loops(fine.triangles))
    assert np.abs((fine.weights @ lifted)[loop, 2]).max() == 0


def test_the_dense_face_passes_through_the_landmarks(face):
    dense = pl.dense_face(face)
    apart = np.linalg.norm(dense.mesh.points[:468] - face.landmarks, axis=1)
    assert np.sqrt((apart**2).mean()) < 0.03
    assert dense.mesh.edge_use == (88 * 4, 0)
    whole = dense.filled().mesh
    assert whole.edge_use == (36 * 4, 0)


def test_landmarks_that_were_not_seen_are_met_nearly(face, random):
    seen = np.sort(random.permutation(468)[:234])
    hidden = np.setdiff1d(np.arange(468), seen)
    guess = subdivided_mean(1).points[:468] + difference(face.landmarks, 1, seen)[:468]

    def off(points):
        return np.sqrt(((points - face.landmarks)[hidden] ** 2).sum(axis=1).mean())

    assert off(guess) < 0.25  # centimetres
    assert off(guess) < 0.35 * off(subdivided_mean(1).points[:468])


def test_texture_of_the_dense_face_is_where_the_photograph_shows_it(face):
    dense = pl.dense_face(face)
    from pliant.face.pose import to_photograph

    places = to_photograph(face.pose, dense.mesh.points)[:, :2]
    assert np.allclose(dense.mesh.uvs.values, face.picture.coordinates(places))
    for wrong in (0, 5):
        with pytest.raises(InvalidParameter, match="1 to 4 times"):
            pl.dense_face(face, wrong)
