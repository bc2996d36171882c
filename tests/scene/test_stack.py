"""Stacks: what they compute, what a change leaves valid, and what they refuse."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scene_shapes import GOAL, HANDLE, MASK, MESH, ROI, lattice, mixed_stack, space_stack

import pliant as pl
from pliant.errors import InvalidParameter, InvalidTarget, NotDifferentiable
from pliant.scene.kinds import build, describe
from pliant.testing import check_deformer

LAYERS = {
    "warp": pl.Layer("warp", lattice(1)),
    "twist": pl.Layer("twist", pl.Twist.around(MESH, angle=0.9), envelope=0.4),
    "scale": pl.Layer("scale", pl.Scale.around(MESH, x=1.3), mask=MASK),
    "edit": pl.Layer("edit", pl.LaplacianEdit(ROI, HANDLE, goal=GOAL)),
}


def naive_space(stack, points):
    """Maps of space, layer by layer, as the definition says."""
    here, total = points, points.copy()
    for layer in stack.active:
        strength = layer.envelope * (1 if layer.mask is None else (1 - layer.mask if layer.invert else layer.mask))
        strength = np.broadcast_to(strength, len(points))[:, None]
        total = total + strength * (layer.deformer(points) - points)
        here = here + strength * (layer.deformer(here) - here)
    return here if stack.mode == "compose" else total


@pytest.mark.parametrize("mode", ["compose", "add"])
def test_it_is_the_formula(mode):
    stack = space_stack().in_mode(mode)
    assert np.abs(stack(MESH).points - naive_space(stack, MESH.points)).max() < 1e-13


@pytest.mark.parametrize("mode", ["compose", "add"])
def test_it_obeys_the_laws_of_deformers(mode):
    check_deformer(space_stack().in_mode(mode), MESH)


def test_the_jacobian_is_the_derivative():
    stack = space_stack().remove("taper")
    for mode in ("compose", "add"):
        jacobian, step = stack.in_mode(mode).jacobian(MESH.points), 1e-5
        for axis in range(3):
            ahead, behind = MESH.points + step * np.eye(3)[axis], MESH.points - step * np.eye(3)[axis]
            slope = (stack.in_mode(mode)(ahead) - stack.in_mode(mode)(behind)) / (2 * step)
            inside = np.abs(HEIGHT_FROM_ENDS) > 1e-3  # where the twist begins and ends it has a kink
            assert np.abs(slope - jacobian[:, :, axis])[inside].max() < 1e-7


HEIGHT_FROM_ENDS = np.minimum(MESH.points[:, 2], 4 - MESH.points[:, 2])


def test_an_empty_stack_is_the_identity():
    assert np.array_equal(pl.Stack()(MESH).points, MESH.points)
    assert pl.Stack().bind(MESH).deform() is not MESH.points
    nothing = np.zeros(0)
    assert len(pl.Stack().moved(nothing)) == 0
    binding = pl.Stack().bind(MESH)
    np.testing.assert_array_equal(binding.jvp(None, nothing), 0.0)
    assert binding.vjp(None, MESH.points).shape == (0,)


def test_what_is_muted_or_alone_decides_who_is_heard():
    stack = space_stack()
    assert stack.replace("twist", muted=True).active == (stack["warp"], stack["taper"])
    alone = stack.replace("taper", solo=True)
    assert [layer.name for layer in alone.active] == ["taper"]
    assert [layer.name for layer in alone.replace("taper", muted=True).active] == ["warp", "twist"]
    assert [layer.name for layer in stack.replace("warp", envelope=0).active] == ["twist", "taper"]


def test_an_envelope_beyond_one_exaggerates():
    twice = pl.Stack([pl.Layer("warp", lattice(), envelope=2.0)])(MESH).points
    assert np.allclose(twice - MESH.points, 2 * (lattice()(MESH.points) - MESH.points), atol=1e-14)


operations = st.lists(
    st.one_of(
        st.tuples(st.just("envelope"), st.sampled_from(sorted(LAYERS)), st.sampled_from([0.0, 0.5, 1.0, 1.5])),
        st.tuples(st.just("muted"), st.sampled_from(sorted(LAYERS)), st.booleans()),
        st.tuples(st.just("solo"), st.sampled_from(sorted(LAYERS)), st.booleans()),
        st.tuples(st.just("invert"), st.sampled_from(sorted(LAYERS)), st.booleans()),
        st.tuples(st.just("move"), st.sampled_from(sorted(LAYERS)), st.integers(0, 3)),
        st.tuples(st.just("controls"), st.sampled_from(["warp", "twist", "scale", "edit"]), st.integers(0, 3)),
        st.tuples(st.just("mode"), st.just(""), st.sampled_from(["compose", "add"])),
    ),
    min_size=1,
    max_size=6,
)


@settings(deadline=None, max_examples=25)
@given(operations)
def test_whatever_is_changed_an_update_is_what_evaluating_anew_gives(changes):
    stack = pl.Stack(LAYERS.values())
    binding = stack.bind(MESH)
    for what, name, value in changes:
        if what == "move":
            stack = stack.move(name, value)
        elif what == "mode":
            stack = stack.in_mode(value)
        elif what == "controls":
            deformer = stack[name].deformer
            stack = stack.replace(name, deformer=deformer.moved(deformer.controls * (1 + 0.01 * value)))
        else:
            stack = stack.replace(name, **{what: value})
        binding = binding.updated(stack)
        assert np.abs(binding.result - stack(MESH).points).max() < 1e-12


class Counted:
    """A deformer that counts what is done with it."""

    def __init__(self, monkeypatch):
        self.bound, self.evaluated = [], []
        bind, once = pl.BSplineFFD.bind, pl.BSplineFFD._deformed
        monkeypatch.setattr(pl.BSplineFFD, "bind", lambda s, t: self.bound.append(s) or bind(s, t))
        monkeypatch.setattr(pl.BSplineFFD, "_deformed", lambda s, t: self.evaluated.append(s) or once(s, t))


def test_a_change_costs_its_layer_and_those_above_and_moving_controls_binds_once(monkeypatch):
    stack = pl.Stack([pl.Layer(str(i), lattice(i)) for i in range(4)])
    binding = stack.bind(MESH)
    counted = Counted(monkeypatch)
    for size in (0.01, 0.02, 0.03):
        stack = stack.replace("3", deformer=lattice(3, size))
        binding = binding.updated(stack)
    assert len(counted.bound) == 1  # at the first move: from then on the layer is known to be worked on
    assert not counted.evaluated
    binding = binding.updated(stack.replace("1", envelope=0.5))
    assert len(counted.evaluated) == 2  # those above, once each
    counted.evaluated.clear()
    undone = binding.updated(stack)
    assert not counted.evaluated
    assert np.array_equal(undone.result, binding.updated(stack).result)


def test_surface_layers_are_bound_to_the_shape_at_rest_once(monkeypatch):
    stack = mixed_stack()
    calls, bind = [], pl.LaplacianEdit.bind
    monkeypatch.setattr(pl.LaplacianEdit, "bind", lambda s, t: calls.append(t) or bind(s, t))
    binding = stack.bind(MESH)
    for angle in (0.1, 0.2):
        stack = stack.replace("warp", deformer=pl.Twist.around(MESH, angle=angle))
        goal = stack["edit"].deformer.controls + angle
        stack = stack.replace("edit", deformer=stack["edit"].deformer.moved(goal))
        binding = binding.updated(stack)
    assert len(calls) == 1
    assert calls[0] is MESH


@pytest.mark.parametrize("edit", [pl.LaplacianEdit(ROI, HANDLE), pl.ARAP(ROI, HANDLE)])
def test_an_edit_turns_with_the_surface_below(edit):
    """Below a rigid motion, the edit is that of the shape at rest, moved."""
    motion = pl.Affine.rotation([1, 2, 0.5], 0.8, origin=[0.3, 0, 1])
    stack = pl.Stack([pl.Layer("move", motion), pl.Layer("edit", edit.moved(GOAL))])
    expected = motion(edit.moved(GOAL)(MESH).points)
    assert np.abs(stack(MESH).points - expected).max() < 1e-9


def test_an_animated_base_carries_what_is_bound_to_the_shape_at_rest():
    motion = pl.Affine.rotation("y", 0.6)
    stack = mixed_stack().remove("warp")
    moving = stack.bind(MESH).updated(stack, base=motion(MESH.points))
    anew = pl.Stack([pl.Layer("move", motion), *stack]).bind(MESH)
    assert np.abs(moving.result - anew.result).max() < 1e-12
    assert np.array_equal(pickle.loads(pickle.dumps(moving)).result, moving.result)


def test_stored_normals_follow(box_mesh):
    turn = pl.Affine.rotation("z", 0.5)
    stack = pl.Stack([pl.Layer("turn", turn), pl.Layer("half", pl.Affine.translation([0, 0, 2.0]), envelope=0.5)])
    expected = box_mesh.normals.per_corner @ turn.linear.T
    assert np.abs(stack(box_mesh).normals.per_corner - expected).max() < 1e-12
    masked = stack.replace("half", mask=np.ones(len(box_mesh.points)))
    assert np.abs(masked(box_mesh).normals.per_corner - stack(box_mesh).normals.per_corner).max() < 1e-9


def test_derivatives_hold_only_where_they_are_known():
    stack, random = mixed_stack(), np.random.default_rng(4)
    with pytest.raises(NotDifferentiable, match="layer 'edit' edits a surface that other layers have turned"):
        stack.bind(MESH).vjp(None, MESH.points)
    with pytest.raises(NotDifferentiable, match="layer 'edit' edits a surface"):
        stack.remove("warp").jacobian(MESH.points)
    binding = stack.move("edit", 0).bind(MESH)
    change, gradient = random.normal(size=binding.rest.shape), random.normal(size=MESH.points.shape)
    pushed, pulled = binding.jvp(None, change), binding.vjp(None, gradient)
    assert np.isclose((pushed * gradient).sum(), change @ pulled, rtol=1e-10)
    step = 1e-6
    ahead, behind = (binding.deform(binding.controls + s * step * change) for s in (1, -1))
    assert np.abs((ahead - behind) / (2 * step) - pushed).max() < 1e-6 * np.abs(pushed).max()


def test_edits_give_other_stacks():
    stack = space_stack()
    assert stack.insert(1, LAYERS["edit"]).names == ("warp", "edit", "twist", "taper")
    assert stack.append(LAYERS["edit"]).names[-1] == "edit"
    assert stack.move("taper", 0).names == ("taper", "warp", "twist")
    assert stack.rename("warp", "bottom").names == ("bottom", "twist", "taper")
    assert stack.remove("twist").names == ("warp", "taper")
    assert stack.names == ("warp", "twist", "taper")


@pytest.mark.parametrize(
    ("call", "cause"),
    [
        (lambda s: pl.Stack([*s, LAYERS["warp"]]), "two layers are called 'warp'"),
        (lambda s: pl.Stack([lattice()]), "holds layers, not a BSplineFFD: wrap it"),
        (lambda s: s.in_mode("multiply"), "'compose' or 'add', not 'multiply'"),
        (lambda s: s["twits"], "no layer 'twits'; there are: warp, twist, taper"),
        (lambda s: s.move("warp", 3), "no place 3 among 3"),
        (lambda s: s.replace("warp", envelop=1), "a layer has no 'envelop'"),
        (lambda s: s.rename("warp", " "), "name is ' '"),
        (lambda s: s.replace("warp", deformer=7), "holds a int: it needs a deformer"),
        (lambda s: s.replace("warp", deformer=s), "insert the layers of one into the other"),
        (lambda s: s.replace("warp", envelope=np.nan), "envelope of layer 'warp' is nan"),
        (lambda s: s.replace("warp", envelope="much"), "'much', no number"),
        (lambda s: s.replace("warp", mask=[[1.0]]), r"mask of layer 'warp' has shape \(1, 1\)"),
        (lambda s: s.replace("warp", mask=["a"]), "numbers are needed"),
        (lambda s: pl.Scene(MESH, s, selections={"top": [0, 999]}), "'top' holds vertex 999"),
        (lambda s: pl.Scene(MESH, s, selections={"top": [0.5]}), "'top' holds vertex indices"),
    ],
)
def test_what_makes_no_sense_is_refused(call, cause):
    with pytest.raises(InvalidParameter, match=cause):
        call(space_stack())


def test_targets_that_do_not_fit_are_refused():
    with pytest.raises(InvalidTarget, match="mask of layer 'taper' has 160 weights; the target has 5 points"):
        space_stack()(MESH.points[:5])
    with pytest.raises(InvalidTarget, match="needs a mesh"):
        mixed_stack()(MESH.points)
    with pytest.raises(InvalidTarget, match="the base has 5 points"):
        space_stack().bind(MESH).updated(space_stack(), base=MESH.points[:5])


def test_equal_content_has_equal_keys_and_other_content_has_not():
    layer = LAYERS["warp"]
    copy = pl.Layer("other", build(*describe(layer.deformer)))
    assert copy.content == layer.content
    assert layer.changed(envelope=0.5).content != layer.content
    moved = layer.changed(deformer=layer.deformer.moved(layer.deformer.rest))
    assert moved.content != layer.content
    assert moved.structure == layer.structure
    assert layer.changed(deformer=pl.BSplineFFD.around(MESH, shape=(5, 4, 5))).structure != layer.structure
