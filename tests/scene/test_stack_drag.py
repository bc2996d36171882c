"""Dragging one layer of a stack: the same as evaluating anew, and only what is touched is named."""

from __future__ import annotations

import numpy as np
import pytest
from scene_shapes import MESH, mixed_stack, space_stack

import pliant as pl

STACKS = {
    f"{name} {mode}": stack.in_mode(mode)
    for name, stack in {
        "space": space_stack(),
        "mixed": mixed_stack(),
        "edit on top": mixed_stack().move("edit", 2).append(pl.Layer("arap", mixed_stack()["edit"].deformer)),
    }.items()
    for mode in ("compose", "add")
}


@pytest.mark.parametrize(("which", "name"), [(key, name) for key, stack in STACKS.items() for name in stack.names])
def test_a_drag_is_what_evaluating_anew_gives(which, name):
    random = np.random.default_rng(5)
    drag = STACKS[which].bind(MESH).drag_layer(name)
    controls = drag.controls
    for _ in range(3):
        rows = controls.reshape(-1, controls.shape[-1]) if controls.ndim > 1 else controls
        rows[random.integers(len(rows))] += 0.05 * random.normal(size=rows[0].shape)
        before = drag.points.copy()
        touched = drag.update(controls)
        assert np.abs(drag.points - drag.stack(MESH).points).max() < 1e-10
        assert np.isin(np.flatnonzero((drag.points != before).any(axis=1)), touched).all()
        assert np.array_equal(drag.controls, controls)
    assert not len(drag.update(controls, changed=[]))
    assert not drag.points.flags.writeable


def test_few_points_travel_where_few_are_touched():
    ffd = pl.BSplineFFD.around(MESH, shape=(3, 3, 20))
    stack = pl.Stack([pl.Layer("warp", ffd), pl.Layer("twist", pl.Twist.around(MESH, angle=0.5))])
    drag, controls = stack.bind(MESH).drag_layer("warp"), ffd.rest.copy()
    controls[1, 1, 10] += 0.1
    touched = drag.update(controls, changed=[(1, 1, 10)])
    assert 0 < len(touched) < 0.3 * len(MESH.points)


def test_a_layer_that_is_left_out_can_be_moved_and_nothing_is_touched():
    binding = space_stack().replace("twist", muted=True).bind(MESH)
    drag = binding.drag_layer("twist", controls=[0.1])
    assert np.array_equal(drag.points, binding.result)
    assert not len(drag.update([1.0]))
    assert drag.stack["twist"].deformer.angle == 1.0
    assert drag.stack["twist"].muted


def test_a_drag_begins_where_it_is_told():
    drag = space_stack().bind(MESH).drag_layer("twist", controls=[1.1])
    expected = space_stack().replace("twist", deformer=pl.Twist.around(MESH, angle=1.1))(MESH).points
    assert np.abs(drag.points - expected).max() < 1e-12
