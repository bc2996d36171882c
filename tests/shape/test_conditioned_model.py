"""A model by hand: coefficients, and landmarks that correct them."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pliant as pl
from pliant.errors import InvalidDeformer, InvalidParameter, InvalidTarget
from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.shape.conditioned_model import ConditionedModel
from pliant.studio.examples.samples import torus
from pliant.testing import check_deformer

VERTICES = [3, 50, 120]
NOISE = 0.01


def ring():
    full = torus(24, 12)
    return pl.PolygonMesh(full.points, full.faces)


@cache
def models():
    """One whose fields serve all coordinates, and the same with fields of its own for each."""
    scalar = pl.ShapeModel.from_kernel(ring(), pl.GaussianKernel(sigma=1.0, scale=0.2), rank=12)
    return {"scalar": scalar, "full": scalar.transformed(np.eye(4))}


@pytest.fixture(params=["scalar", "full"])
def model(request):
    return models()[request.param]


def somewhere(model, seed=0):
    """Away from rest in all controls."""
    random = np.random.default_rng(seed)
    goals = model.mean[VERTICES] + 0.1 * random.standard_normal((3, 3))
    return ConditionedModel(model, random.standard_normal(model.count), VERTICES, goals, NOISE)


def test_it_is_a_deformer(model):
    check_deformer(somewhere(model), ring(), rest_image=model.mean)
    check_deformer(ConditionedModel(model, np.ones(model.count)), ring(), rest_image=model.mean)


def test_without_coefficients_it_is_the_mean_of_the_posterior(model):
    shape = somewhere(model).moved(np.concatenate([np.zeros(model.count), somewhere(model).controls[model.count :]]))
    known = model.posterior(VERTICES, shape.positions, noise=NOISE)
    np.testing.assert_allclose(shape(ring()).points, known.mean, atol=1e-12)
    np.testing.assert_allclose(shape.posterior().mean, known.mean, atol=1e-12)


def test_without_landmarks_it_is_the_model(model):
    coefficients = np.random.default_rng(1).standard_normal(model.count)
    shape = ConditionedModel(model, coefficients)
    np.testing.assert_array_equal(shape.corrected, coefficients)
    np.testing.assert_allclose(shape(ring()).points, model.instance(coefficients), atol=1e-12)
    assert shape.posterior() is model


def test_the_coefficients_it_tells_are_those_of_its_shape(model):
    shape = somewhere(model)
    np.testing.assert_allclose(model.instance(shape.corrected), shape(ring()).points, atol=1e-12)
    np.testing.assert_allclose(shape.points, shape(ring()).points, atol=1e-12)


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 1000), vertex=st.integers(0, 287))
def test_a_new_landmark_moves_nothing(seed, vertex):
    for model in models().values():
        before = somewhere(model, seed)
        after = before.with_landmark(vertex)
        np.testing.assert_allclose(after.points, before.points, atol=1e-9)
        np.testing.assert_allclose(after.without_landmarks([3]).points, before.points, atol=1e-9)


def test_random_coefficients_make_samples_of_the_posterior_but_for_the_noise():
    """Matheron's rule: with the observations perturbed by their noise the samples have the posterior's covariance."""
    model = models()["scalar"]
    shape, random = somewhere(model), np.random.default_rng(2)
    goals = np.asarray(shape.positions)
    drawn = []
    for _ in range(4000):
        noisy = goals + NOISE * random.standard_normal(goals.shape)
        drawn.append(shape.moved(np.concatenate([random.standard_normal(model.count), noisy.reshape(-1)])).corrected)
    known = model.posterior(VERTICES, goals, noise=NOISE)
    fields = known.basis.matrix  # of the coefficients: M Mᵀ is their covariance
    covariance = np.kron(fields @ fields.T, np.eye(3))
    found = np.cov(np.array(drawn).T)
    assert np.linalg.norm(found - covariance) < 0.1 * np.linalg.norm(covariance)
    met = model.instance(drawn[-1])[VERTICES] - goals
    assert np.abs(met).max() < 10 * NOISE


def test_uncertainty_vanishes_at_landmarks_and_grows_away_from_them(model):
    known = somewhere(model).posterior()
    assert known.uncertainty[VERTICES].max() < 2 * NOISE
    assert known.uncertainty.max() > 10 * NOISE
    columns = known.basis.columns()
    np.testing.assert_allclose(known.uncertainty, np.sqrt((columns**2).sum(axis=(1, 2))), rtol=1e-9)


def test_it_is_kept_in_projects_with_all_that_it_knows(model, tmp_path):
    shape = somewhere(model)
    scene = Scene(ring(), Stack((Layer("model", shape),)))
    pl.save_project(scene, tmp_path / "shape.pliant")
    again = pl.load_project(tmp_path / "shape.pliant")
    np.testing.assert_array_equal(again.deformed().points, scene.deformed().points)
    np.testing.assert_array_equal(again.stack["model"].deformer.vertices, VERTICES)


def test_a_drag_begins_where_the_layer_is(model):
    shape = somewhere(model)
    binding = Stack((Layer("model", shape),)).bind(ring())
    other = binding.updated(binding.stack.replace("model", deformer=shape.moved(shape.controls * 0.5)))
    drag = other.drag_layer("model")  # the binding of the structure is the first one's
    np.testing.assert_array_equal(drag.controls, shape.controls * 0.5)
    drag.update(shape.controls * 0.7)
    np.testing.assert_allclose(drag.points, shape.moved(shape.controls * 0.7)(ring()).points, atol=1e-12)


def test_what_it_cannot_take_is_named(model):
    with pytest.raises(InvalidParameter, match="vertex 9999 is not in the model"):
        ConditionedModel(model, vertices=[9999])
    with pytest.raises(InvalidDeformer, match="1 landmarks have positions"):
        ConditionedModel(model, vertices=[1], positions=np.zeros((2, 3)))
    with pytest.raises(InvalidDeformer, match="not finite"):
        ConditionedModel(model, vertices=[1], positions=[[np.nan, 0, 0]])
    with pytest.raises(InvalidParameter, match="noise"):
        ConditionedModel(model, vertices=[1], noise=0.0)
    with pytest.raises(InvalidParameter, match="vertex 9999 is not in the model"):
        ConditionedModel(model).with_landmark(9999)
    with pytest.raises(InvalidParameter, match="it has 1, counted from 0"):
        ConditionedModel(model).with_landmark(3).without_landmarks([1])
    with pytest.raises(InvalidTarget, match="a model moves its own mesh"):
        ConditionedModel(model)(torus(12, 12))
