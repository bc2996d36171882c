"""Baking keeps the result; shape keys are a deformer like all others."""

from __future__ import annotations

import numpy as np
import pytest
from scene_shapes import MESH, mixed_stack, space_stack

import pliant as pl
from pliant.errors import InvalidDeformer, InvalidParameter, InvalidTarget
from pliant.testing import check_deformer


def keys():
    moves = np.random.default_rng(1).normal(size=(3, len(MESH.points), 3))
    return pl.ShapeKeys(moves, ("a", "b", "c"), [0.5, 0.0, -1.0])


def test_shape_keys_obey_the_laws_of_deformers():
    check_deformer(keys(), MESH)


@pytest.mark.parametrize("name", ["warp", "twist", "taper", None])
def test_what_is_baked_and_what_is_left_are_together_what_they_were(name):
    stack = space_stack()
    mesh, left = pl.bake(stack, MESH, name)
    assert np.abs(left(mesh).points - stack(MESH).points).max() < 1e-12
    assert left.names == stack.names[0 if name is None else stack.index(name) + 1 :][: len(left)]


def test_all_layers_can_always_be_baked():
    for stack in (mixed_stack(), mixed_stack().in_mode("add")):
        mesh, left = pl.bake(stack, MESH)
        assert np.array_equal(mesh.points, stack(MESH).points)
        assert not len(left)


@pytest.mark.parametrize("mode", ["compose", "add"])
def test_shape_keys_of_a_stack_are_the_stack(mode):
    stack = mixed_stack().in_mode(mode)
    found = pl.bake_shape_keys(stack, MESH)
    assert found.names == stack.names
    assert np.abs(found.bind(MESH).deform() - stack(MESH).points).max() < 1e-12
    one = pl.Stack(stack.layers[:1], mode)(MESH).points
    assert np.abs(found.bind(MESH).deform([1, 0, 0]) - one).max() < 1e-12
    assert pl.bake_shape_keys(stack.replace("edit", muted=True), MESH).names == ("warp", "twist")


@pytest.mark.parametrize(
    ("call", "error", "cause"),
    [
        (
            lambda: pl.bake(mixed_stack(), MESH, "warp"),
            InvalidParameter,
            "layer 'edit' edits the shape at rest: bake it too",
        ),
        (lambda: pl.bake(space_stack().in_mode("add"), MESH, "warp"), InvalidParameter, "bake all of them, or none"),
        (lambda: pl.bake(space_stack().replace("warp", solo=True), MESH), InvalidParameter, "a layer is solo"),
        (lambda: pl.bake(space_stack(), MESH, "none"), InvalidParameter, "no layer 'none'"),
        (lambda: pl.ShapeKeys(np.zeros((2, 3))), InvalidDeformer, r"\(k, n, 3\) finite numbers"),
        (lambda: pl.ShapeKeys(np.zeros((2, 5, 3)), ("a",)), InvalidDeformer, "2 keys have 1 names"),
        (lambda: keys()(MESH.points[:5]), InvalidTarget, "the target has 5 points; the keys move 160"),
    ],
)
def test_what_would_not_do_the_same_is_refused(call, error, cause):
    with pytest.raises(error, match=cause):
        call()
