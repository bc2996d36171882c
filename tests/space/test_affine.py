"""Affine maps: the group they form, their twelve numbers, and their inverse."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import InvalidControls, InvalidDeformer, NonFiniteResult
from pliant.mesh import PolygonMesh
from pliant.space.affine import Affine
from pliant.testing import check_deformer

POINTS = np.random.default_rng(3).normal(size=(20, 3))

maps = st.integers(0, 10_000).map(
    lambda seed: Affine.of(np.eye(3) + 0.3 * np.random.default_rng(seed).normal(size=(3, 3)), [seed % 7, 1, -2])
)


@settings(deadline=None, max_examples=40)
@given(maps, maps)
def test_composition_is_the_product(a, b):
    assert np.allclose((a @ b)(POINTS), a(b(POINTS)), atol=1e-12)


@settings(deadline=None, max_examples=40)
@given(maps.filter(lambda a: np.linalg.cond(a.linear) < 1e4))
def test_inverse_undoes(a):
    assert np.allclose(a.inverse(a(POINTS)), POINTS, atol=1e-9)
    assert np.allclose((a @ a.inverted()).matrix, np.eye(4), atol=1e-9)


def test_obeys_the_laws_of_deformers():
    check_deformer(Affine.rotation([1, 2, 3], 0.7) @ Affine.scaling([1, 2, 0.5], origin=[1, 1, 1]), POINTS)


def test_rest_is_the_identity_exactly():
    moved = Affine.translation([1, 2, 3])
    assert (moved.moved(moved.rest)(POINTS) == POINTS).all()


def test_rotation_is_right_handed_about_its_origin():
    turn = Affine.rotation("z", np.pi / 2, origin=[1, 0, 0])
    assert np.allclose(turn([[2, 0, 5], [1, 0, 0]]), [[1, 1, 5], [1, 0, 0]])
    about = Affine.rotation([1, 1, 1], 2 * np.pi / 3)
    assert np.allclose(about(np.eye(3)), np.roll(np.eye(3), 1, axis=1))


def test_scaling_keeps_its_origin():
    assert np.allclose(Affine.scaling([2, 3, 4], origin=[1, 1, 1])([[1, 1, 1], [2, 2, 2]]), [[1, 1, 1], [3, 4, 5]])
    assert np.isclose(np.linalg.det(Affine.scaling(2).linear), 8)


def test_the_weights_are_the_map_and_their_transpose_the_gradient():
    a = Affine.rotation("x", 0.4)
    bound = a.bind(POINTS)
    rng = np.random.default_rng(0)
    step, gradient = rng.normal(size=12), rng.normal(size=POINTS.shape)
    assert np.allclose(POINTS + (bound.weights @ (a.controls - a.rest)).reshape(-1, 3), bound.deform())
    assert np.isclose((bound.jvp(None, step) * gradient).sum(), step @ bound.vjp(None, gradient))
    assert np.allclose(bound.weights.T @ gradient.reshape(-1), bound.vjp(None, gradient))
    assert np.allclose(bound.deform(a.controls + step) - bound.deform(), bound.jvp(None, step))


def test_normals_follow_the_cofactor_matrix():
    plane = PolygonMesh(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 1.0]]), [[0, 1, 2]])
    plane = plane.replace(vertex_attributes={"normals": np.tile([0, -np.sqrt(0.5), np.sqrt(0.5)], (3, 1))})
    squeezed = Affine.scaling([3, 1, 0.2])(plane)
    edges = squeezed.points[1:] - squeezed.points[0]
    assert np.allclose(squeezed.vertex_attributes["normals"] @ edges.T, 0, atol=1e-12)


def test_refusals_name_the_cause():
    with pytest.raises(InvalidDeformer, match="last row"):
        Affine(np.ones((4, 4)))
    with pytest.raises(InvalidDeformer, match="finite"):
        Affine.translation([np.nan, 0, 0])
    with pytest.raises(InvalidDeformer, match="shape"):
        Affine(np.eye(3))
    with pytest.raises(InvalidDeformer, match="flattens"):
        Affine.scaling([1, 1, 0]).inverted()
    with pytest.raises(InvalidDeformer, match="no axis"):
        Affine.rotation("w", 1.0)
    for build in (
        lambda: Affine.translation([1, 2]),
        lambda: Affine.scaling([1, 2]),
        lambda: Affine.scaling(2, origin=1),
        lambda: Affine.of("wrong"),
    ):
        with pytest.raises(InvalidDeformer, match="needed"):
            build()
    with pytest.raises(NonFiniteResult, match="affine map"):
        Affine.scaling(1e300)(np.full((1, 3), 1e300))
    with pytest.raises(InvalidControls):
        Affine().moved(np.zeros(9))


def test_pickles():
    bound = pickle.loads(pickle.dumps(Affine.rotation("y", 1.0).bind(POINTS)))
    assert (bound.deform() == Affine.rotation("y", 1.0)(POINTS)).all()
