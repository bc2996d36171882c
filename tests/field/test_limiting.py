"""The limit before a fold: safe on every step of the way, and the largest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pliant as pl
from pliant.errors import InvalidDeformer, InvalidParameter

BOX = np.array([[0.0, 0, 0], [2.0, 3.0, 1.0]])


def wild(kind, seed, strength):
    rest = pl.BSplineFFD.around(BOX, shape=(4, 4, 4), edge=kind) if kind in ("clamp", "zero") else pl.BezierFFD.around(
        BOX, **({"shape": (3, 4, 3)} if kind == "degrees" else {"patches": (1, 2, 1)})
    )  # fmt: skip
    steps = (BOX[1] - BOX[0]) / (np.array(rest.shape) - 1)
    return rest.moved(rest.rest + strength * steps * np.random.default_rng(seed).normal(size=rest.rest.shape))


def share(limited, deformer):
    """By which number the displacements were multiplied; asserts that it is one number."""
    largest = np.abs(deformer.displacements).argmax()
    t = limited.displacements.flat[largest] / deformer.displacements.flat[largest]
    assert np.allclose(limited.displacements, t * deformer.displacements, rtol=1e-12)
    return t


def least_ratio(deformer, t, points):
    """The least det J of a lattice with its displacements times t."""
    slope = deformer.jacobian(points) - np.eye(3)
    return np.linalg.det(np.eye(3) + t * slope).min()


@given(
    kind=st.sampled_from(["clamp", "zero", "degrees", "patches"]),
    seed=st.integers(0, 100_000),
    strength=st.sampled_from([0.5, 1.0, 3.0]),
    margin=st.sampled_from([1e-3, 0.1]),
)
@settings(deadline=None, max_examples=12)
def test_every_step_up_to_the_limit_keeps_the_margin_and_the_limit_certifies(kind, seed, strength, margin):
    deformer = wild(kind, seed, strength)
    limited = pl.limit_to_fold_free(deformer, margin)
    proof = pl.certify(limited)
    assert proof.status == "fold-free"
    assert proof.least >= margin * (1 - 1e-6)
    t = share(limited, deformer)
    reach = (BOX[1] - BOX[0]) * (kind in ("clamp", "zero"))
    points = np.random.default_rng(seed).uniform(BOX[0] - reach, BOX[1] + reach, (5000, 3))
    for step in np.linspace(0, t, 9):
        assert least_ratio(deformer, step, points) >= margin - 1e-12
    if t < 1:  # a little farther, the margin is lost
        beyond = pl.certify(replace(deformer, displacements=min(1.0, 1.01 * t) * deformer.displacements))
        assert beyond.least < margin


def test_what_folds_nowhere_comes_back_itself():
    gentle = wild("clamp", 0, 0.1)
    assert pl.limit_to_fold_free(gentle) is gentle


def test_a_fold_on_the_way_counts_though_the_end_is_sound():
    """Half a turn about z: at t = 1 an isometry, in the middle everything is flat."""
    rest = pl.BezierFFD.around(BOX - BOX.mean(axis=0), shape=(2, 2, 2))
    turned = rest.moved(rest.rest * [-1, -1, 1])
    assert pl.certify(turned).least == pytest.approx(1)
    limited = pl.limit_to_fold_free(turned, 0.04)
    t = share(limited, turned)
    assert (1 - 2 * t) ** 2 == pytest.approx(0.04, rel=0.01)
    assert t == pytest.approx(0.4, rel=2e-3)
    assert t <= 0.4


def test_the_affine_part_stays_and_a_placed_tool_is_limited_in_its_frame():
    deformer = replace(wild("zero", 1, 2.0), affine=np.diag([1.5, 1.0, 1.0, 1.0]))
    limited = pl.limit_to_fold_free(deformer)
    assert (limited.affine == deformer.affine).all()
    placed = pl.limit_to_fold_free(pl.place(deformer, pl.Affine.rotation("z", 1.0)))
    assert np.array_equal(placed.deformer.displacements, limited.displacements)


def test_bad_input():
    with pytest.raises(InvalidParameter, match="between 0 and 1"):
        pl.limit_to_fold_free(wild("clamp", 0, 1.0), 1.5)
    with pytest.raises(InvalidParameter, match="margin"):
        pl.limit_to_fold_free(wild("clamp", 0, 1.0), 0.0)
    with pytest.raises(InvalidDeformer, match="Twist is no lattice"):
        pl.limit_to_fold_free(pl.Twist(axis="z", angle=1.0))


def test_a_small_budget_is_safe_and_says_so():
    deformer = wild("zero", 7, 3.0)
    with pytest.warns(pl.PliantWarning, match="the lower one is taken"):
        limited = pl.limit_to_fold_free(deformer, budget=64)
    assert share(limited, deformer) <= share(pl.limit_to_fold_free(deformer), deformer)
    assert pl.certify(limited).status == "fold-free"
