"""Principal components and what they are worth."""

import numpy as np
import pytest

import pliant as pl
from pliant.errors import InvalidMesh, InvalidParameter
from pliant.shape.metrics import compactness, generalization, leave_one_out, specificity
from pliant.shape.procrustes import moved


@pytest.fixture
def examples(soft):
    return [soft.reference.with_points(each) for each in soft.truncated(2).sample(30, seed=5)]


def test_all_examples_are_shapes_of_the_model(examples):
    model = pl.learn_model(examples, align=False)
    assert model.rank == 6  # two scalar fields, three coordinates each
    np.testing.assert_allclose(model.mean, np.mean([each.points for each in examples], axis=0))
    for each in examples[:5]:
        np.testing.assert_allclose(model.project(each), each.points, atol=1e-9)
    columns = model.basis.columns().reshape(3 * len(model.mean), -1)
    flat = np.stack([each.points.reshape(-1) for each in examples])
    np.testing.assert_allclose(columns @ columns.T, np.cov(flat.T), atol=1e-10)
    assert model.noise_variance == pytest.approx(0, abs=1e-20)


def test_coefficients_of_the_examples_are_normal(examples):
    model = pl.learn_model(examples, align=False)
    given = np.stack([model.coefficients(each) for each in examples])
    np.testing.assert_allclose(given.mean(axis=0), 0, atol=1e-8)
    np.testing.assert_allclose(np.cov(given.T), np.eye(6), atol=1e-7)


def test_motions_are_taken_out(examples):
    turned = []
    for number, each in enumerate(examples):
        angle = 0.3 * number
        matrix = np.eye(4)
        matrix[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        matrix[:3, 3] = number
        turned.append(each.with_points(moved(matrix, each.points)))
    one, two = pl.learn_model(examples), pl.learn_model(turned)
    np.testing.assert_allclose(one.variances[:3], two.variances[:3], rtol=1e-4)


def test_what_is_left_out_is_the_noise(examples):
    whole, part = pl.learn_model(examples, align=False), pl.learn_model(examples, align=False, rank=4)
    np.testing.assert_allclose(part.variances, whole.variances[:4])
    assert part.noise_variance == pytest.approx(whole.variances[4:].sum() / whole.mean.size)


def test_metrics_of_a_known_model(examples):
    model = pl.learn_model(examples, align=False)
    np.testing.assert_allclose(compactness(model), np.cumsum(model.variances) / model.variances.sum())
    np.testing.assert_allclose(generalization(model, examples), 0, atol=1e-9)
    np.testing.assert_allclose(leave_one_out(examples, align=False), 0, atol=1e-8)  # 29 examples span the same fields
    assert leave_one_out(examples, align=False, rank=1).mean() > 0.05
    lone = specificity(model, examples[:1], align=False, samples=4000)
    shapes = model.sample(4000, seed=0) - examples[0].points
    assert lone == pytest.approx(np.sqrt((shapes**2).sum(axis=2).mean(axis=1)).mean())
    assert specificity(model, examples, align=False) < lone


@pytest.mark.parametrize(
    ("make", "kind", "words"),
    [
        (lambda e: pl.learn_model(e[:1]), InvalidParameter, "two examples or more"),
        (lambda e: pl.learn_model(e, rank=0), InvalidParameter, "rank is 0"),
        (lambda e: pl.learn_model([e[0], pl.PolygonMesh(np.eye(3))]), InvalidMesh, "example 1 has 3 vertices"),
        (lambda e: pl.learn_model([e[0], e[0]]), InvalidMesh, "all alike"),
        (lambda e: leave_one_out(e[:2]), InvalidParameter, "three examples"),
    ],
)
def test_what_teaches_nothing_is_refused(examples, make, kind, words):
    with pytest.raises(kind, match=words):
        make(examples)
