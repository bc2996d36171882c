"""Clips: easings, keys, placements, endings, and motions that a clip enhances."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scene_shapes import GOAL, HANDLE, MESH, ROI, lattice, mixed_stack, space_stack

import pliant as pl
from pliant.errors import InvalidParameter
from pliant.scene.easing import CURVES, NAMES, eased
from pliant.scene.motions import between
from pliant.scene.track import Key, Track

TWIST = pl.Stack([pl.Layer("twist", pl.Twist.around(MESH, angle=0.5))])
parts = st.floats(0, 1)


def clip(**changes):
    return pl.Clip(MESH, TWIST, **{"duration": 2.0, "fps": 10, **changes})


@pytest.mark.parametrize("name", NAMES)
def test_easings_begin_and_end_where_they_must(name):
    assert eased(name, 0.0) == pytest.approx(0.0, abs=1e-12)
    assert eased(name, 1.0) == pytest.approx(1.0, abs=1e-12)


@settings(deadline=None)
@given(parts)
def test_easings_that_are_each_others_mirror(part):
    assert eased("ease_in", part) == pytest.approx(1 - eased("ease_out", 1 - part), abs=1e-9)
    for symmetric in ("ease_in_out", "smooth", "linear"):
        assert eased(symmetric, part) == pytest.approx(1 - eased(symmetric, 1 - part), abs=1e-9)


@settings(deadline=None)
@given(parts, st.sampled_from(sorted(CURVES)))
def test_a_bezier_curve_passes_through_its_own_points(s, name):
    """At the curve's parameter s its time is x(s), and there its value is y(s)."""
    x1, y1, x2, y2 = CURVES[name]
    x, y = (3 * (1 - s) ** 2 * s * a + 3 * (1 - s) * s**2 * b + s**3 for a, b in ((x1, x2), (y1, y2)))
    assert eased(name, x) == pytest.approx(y, abs=1e-6)


def test_a_bezier_curve_with_handles_on_the_diagonal_is_a_line():
    assert eased((0.25, 0.25, 0.75, 0.75), 0.37) == pytest.approx(0.37, abs=1e-12)


def test_values_between_keys():
    track = Track("a", "angle", (Key(1.0, 2.0), Key(2.0, 4.0), Key(3.0, 0.0, "step"), Key(4.0, 1.0, "ease_in")))
    assert [float(track.at(t)) for t in (0, 1, 1.5, 2, 2.99, 3, 9)] == [2, 2, 3, 4, 4, 0, 1]
    assert float(track.at(3.5)) == pytest.approx(eased("ease_in", 0.5))


@settings(deadline=None)
@given(st.lists(st.floats(-5, 5), min_size=3, max_size=6), st.floats(0.1, 2.0))
def test_a_cubic_track_is_smooth_and_passes_through_its_keys(values, width):
    keys = tuple(Key(i * width, value, "cubic") for i, value in enumerate(values))
    track, step = Track("a", "angle", keys), 1e-6 * width
    for i, value in enumerate(values):
        assert float(track.at(i * width)) == pytest.approx(value, abs=1e-12)
        before, after = (float(track.at(i * width + s * step)) for s in (-1, 1))
        if 0 < i < len(values) - 1:
            assert (after - value) / step == pytest.approx((value - before) / step, abs=1e-4 / width)


def test_a_cubic_track_reproduces_a_parabola_between_inner_keys():
    keys = tuple(Key(t, t * t, "cubic") for t in (0.0, 1.0, 1.5, 3.0, 4.0))
    track = Track("a", "angle", keys)
    for time in (1.2, 1.4, 1.7, 2.5):
        assert float(track.at(time)) == pytest.approx(time * time, abs=1e-12)


def test_keys_are_applied_and_a_later_one_at_the_same_time_replaces():
    moving = clip().key("twist", 0.0, {"angle": 0.0}).key("twist", 2.0, {"angle": 1.5}, "ease_in_out")
    assert moving.stack_at(2.0)["twist"].deformer.angle == 1.5
    assert moving.stack_at(1.0)["twist"].deformer.angle == pytest.approx(0.75)
    expected = pl.Twist.around(MESH, angle=0.75)(MESH.points)
    assert np.abs(moving.sample(1.0).points - expected).max() < 1e-9
    again = moving.key("twist", 2.0, {"angle": 3.0})
    assert again.stack_at(2.0)["twist"].deformer.angle == 3.0
    assert moving.stack_at(2.0)["twist"].deformer.angle == 1.5
    assert not again.without_key("twist", "angle", 2.0).without_key("twist", "angle", 0.0).tracks


def test_envelopes_muting_controls_and_vectors_have_keys():
    stack = space_stack()
    moved = stack["warp"].deformer.rest
    moving = pl.Clip(MESH, stack, duration=1.0)
    moving = moving.key("warp", 0.0, {"controls": stack["warp"].deformer.controls, "envelope": 1.0})
    moving = moving.key("warp", 1.0, {"controls": moved, "envelope": 0.0})
    moving = moving.key("twist", 0.0, {"muted": 0.0, "origin": (0, 0, 0), "bounds": (0, 1)})
    moving = moving.key("twist", 0.5, {"muted": 1.0, "origin": (1, 0, 0), "bounds": (1, 4)}, "step")
    half = moving.stack_at(0.5)
    assert half["warp"].envelope == 0.5
    assert np.allclose(half["warp"].deformer.displacements, stack["warp"].deformer.displacements / 2)
    assert half["twist"].muted
    assert not moving.stack_at(0.4)["twist"].muted
    assert half["twist"].deformer.bounds == (1.0, 4.0)
    assert np.abs(moving.sample(0.5).points - half(MESH).points).max() < 1e-12


def test_the_tool_moves_over_the_object():
    start, end = pl.Affine.translation([0, 0, 0]), pl.Affine.translation([0, 0, 2.0])
    moving = pl.Clip(MESH, pl.Stack([pl.Layer("tool", lattice())])).key("tool", 0.0, {"frame": start})
    moving = moving.key("tool", 1.0, {"frame": end})
    expected = pl.place(lattice(), pl.Affine.translation([0, 0, 1.0]))(MESH.points)
    assert np.abs(moving.sample(0.5).points - expected).max() < 1e-12


def test_the_object_moves_through_the_tool():
    stack = pl.Stack([pl.Layer("path", pl.Affine()), pl.Layer("tool", lattice())])
    turn = pl.Affine.rotation("z", 2.0, origin=[1, 0, 0])
    moving = pl.Clip(MESH, stack).key("path", 0.0, {"matrix": np.eye(4)}).key("path", 1.0, {"matrix": turn.matrix})
    half = pl.Affine.rotation("z", 1.0, origin=[1, 0, 0])
    assert np.abs(moving.sample(0.5).points - lattice()(half(MESH.points))).max() < 1e-12


angles = st.floats(-3.0, 3.0)
places = st.tuples(*[st.floats(-5, 5)] * 3)
axes = st.sampled_from(["x", "y", "z", (1.0, 1.0, 0.0), (1.0, -2.0, 0.5)])


@settings(deadline=None)
@given(axes, angles, places, parts)
def test_between_placements_lies_the_part_of_the_turn(axis, angle, place, part):
    whole, some = (pl.Affine.rotation(axis, a, origin=place).matrix for a in (angle, part * angle))
    assert np.abs(between(np.eye(4), whole, part) - some).max() < 1e-7


@settings(deadline=None)
@given(axes, angles, places, places, parts)
def test_what_lies_between_does_not_depend_on_the_origin(axis, angle, place, shift, part):
    first = pl.Affine.rotation("y", 0.4, origin=shift).matrix
    whole = pl.Affine.rotation(axis, angle, origin=place).matrix @ pl.Affine.scaling(1.5).matrix
    move, back = pl.Affine.translation(shift).matrix, pl.Affine.translation(-np.array(shift)).matrix
    one = move @ between(first, whole, part) @ back
    two = between(move @ first @ back, move @ whole @ back, part)
    assert np.abs(one - two).max() < 1e-6
    for end, expected in ((0.0, first), (1.0, whole)):
        assert np.abs(between(first, whole, end) - expected).max() < 1e-7


def test_a_half_turn_is_a_turn():
    for axis in ("x", "y", "z", [1.0, 2.0, -0.5]):
        quarter = between(np.eye(4), pl.Affine.rotation(axis, np.pi).matrix, 0.5)[:3, :3]
        assert np.abs(quarter @ quarter - pl.Affine.rotation(axis, np.pi).linear).max() < 1e-9
        assert np.linalg.det(quarter) == pytest.approx(1.0)


def test_endings():
    keyed = {"tracks": clip().key("twist", 0.0, {"angle": 0.0}).key("twist", 2.0, {"angle": 2.0}).tracks}

    def angle(moving, time):
        return moving.stack_at(time)["twist"].deformer.angle

    once, loop, pong = (clip(ending=ending, **keyed) for ending in ("once", "loop", "ping-pong"))
    assert [angle(once, t) for t in (-1, 0.5, 3)] == pytest.approx([0, 0.5, 2])
    assert [angle(loop, t) for t in (0.5, 2.5, 4.5)] == pytest.approx([0.5, 0.5, 0.5])
    assert [angle(pong, t) for t in (0.5, 2.5, 3.5, 4.5)] == pytest.approx([0.5, 1.5, 0.5, 0.5])
    assert (len(once.times), len(loop.times), len(pong.times)) == (21, 20, 40)
    assert once.times[-1] == 2.0


def test_frames_are_samples_and_progress_is_told():
    moving = pl.Clip(MESH, mixed_stack(), duration=0.5, fps=8).key("twist", 0.0, {"angle": 0.0})
    moving = moving.key("twist", 0.5, {"angle": 1.0})
    told = []
    frames = list(moving.frames(lambda done, count: told.append((done, count))))
    assert told == [(i + 1, 5) for i in range(5)]
    for frame in frames:
        assert np.abs(frame.points - moving.sample(frame.time).points).max() < 1e-12
    sequence = moving.sequence()
    assert np.array_equal(sequence.at(0.25), frames[2].points)


def test_intensity_scales_displacements():
    points = clip(intensity=0.3).sample(0.0).points
    expected = MESH.points + 0.3 * (TWIST(MESH).points - MESH.points)
    assert np.abs(points - expected).max() < 1e-13


def test_a_motion_is_enhanced_and_exaggerated():
    shifts = np.array([0.0, 1.0])
    motion = pl.MeshSequence(MESH.points + shifts[:, None, None], [0.0, 2.0])
    edit = pl.Stack([pl.Layer("edit", pl.LaplacianEdit(ROI, HANDLE, goal=GOAL))])
    moving = pl.Clip(MESH, edit, duration=2.0, motion=motion, amplify=3.0)
    expected = edit(MESH).points + 1.5  # half the way, three times as far
    assert np.abs(moving.sample(1.0).points - expected).max() < 1e-9
    assert np.abs(motion.amplified(MESH.points, 3.0).at(1.0) - MESH.points - 1.5).max() < 1e-12


def test_normals_of_samples_follow(box_mesh):
    stack = pl.Stack([pl.Layer("turn", pl.Affine())])
    moving = pl.Clip(box_mesh, stack).key("turn", 0.0, {"matrix": pl.Affine.rotation("z", 1.0).matrix})
    expected = box_mesh.normals.per_corner @ pl.Affine.rotation("z", 1.0).linear.T
    assert np.abs(moving.sample(0.0).normals.per_corner - expected).max() < 1e-12


def test_a_clip_on_another_stack_keeps_the_keys_that_still_have_a_layer():
    moving = pl.Clip(MESH, space_stack()).key("twist", 0.0, {"angle": 1.0}).key("warp", 0.0, {"envelope": 0.5})
    scene = pl.Scene(MESH, space_stack().remove("twist"), moving)
    assert [(track.layer, track.field) for track in scene.clip.tracks] == [("warp", "envelope")]
    assert scene.clip.stack is scene.stack


@pytest.mark.parametrize(
    ("call", "cause"),
    [
        (lambda: clip(duration=0.0), "the clip is empty: its duration is 0.0"),
        (lambda: clip(fps=np.nan), "fps is nan"),
        (lambda: clip(intensity=np.inf), "intensity is inf"),
        (lambda: clip(ending="stop"), "'once', 'loop' or 'ping-pong', not 'stop'"),
        (lambda: clip(motion=pl.MeshSequence(np.zeros((1, 5, 3)), [0.0])), "one of 5 points; the mesh has 160"),
        (lambda: clip().key("twits", 0.0, {"angle": 0}), "no layer 'twits'"),
        (lambda: clip().key("twist", 0.0, {"angel": 0}), "has no 'angel' that could have keys; it has: origin, bounds"),
        (lambda: clip().key("twist", 0.0, {"axis": 0}), "no 'axis' that could have keys"),
        (lambda: clip().key("twist", 0.0, {"angle": [1, 2]}), r"'angle' of layer 'twist' has shape \(\)"),
        (lambda: clip().key("twist", 0.0, {"angle": "wide"}), "numbers are needed"),
        (lambda: clip().key("twist", 0.0, {"angle": np.nan}), "is refused|not finite"),
        (lambda: clip().key("twist", 0.0, {"controls": [1, 2]}), "is refused: controls have shape"),
        (lambda: clip().key("twist", 0.0, {"bounds": [2, 1]}), "is refused: bounds .* are reversed"),
        (lambda: clip().key("twist", 0.0, {"envelope": [1, 2]}), "'envelope' of layer 'twist' is one number"),
        (lambda: clip().key("twist", 0.0, {"frame": np.eye(3)}), r"frame of layer 'twist' has shape \(3, 3\)"),
        (lambda: clip().key("twist", -1.0, {"angle": 0}), "times are finite and not negative"),
        (lambda: clip().key("twist", 0.0, {"angle": 0}, "quick"), "no easing 'quick'; there are: step, linear"),
        (lambda: clip().key("twist", 0.0, {"angle": 0}, (2, 0, 1, 1)), "x1 and x2 are times between 0 and 1"),
        (lambda: clip().key("twist", 0.0, {"angle": 0}, (1, 2)), "is no easing: pass a name, or four numbers"),
        (lambda: clip().without_key("twist", "angle", 0.0), "has no keys"),
        (lambda: clip().key("twist", 0, {"angle": 0}).without_key("twist", "angle", 1), "has no key at 1 s"),
        (lambda: clip(tracks=(Track("twist", "angle", (Key(0, 0),)),) * 2), "has two tracks"),
        (lambda: Track("a", "b", ()), "'b' of layer 'a' has no keys"),
        (lambda: Track("a", "b", (Key(1, 0), Key(0, 0))), "out of order: one at 1 s comes before one at 0 s"),
        (lambda: Track("a", "b", (Key(0, 0), Key(1, [0]))), "values of different shapes"),
        (lambda: pl.MeshSequence(np.zeros((0, 5, 3)), []), "one frame or more"),
        (lambda: pl.MeshSequence(np.zeros((2, 5, 3)), [1, 1]), "finite times that ascend"),
        (lambda: pl.MeshSequence(np.full((1, 5, 3), np.nan), [0]), "frame 0 holds positions that are not finite"),
        (
            lambda: pl.Clip(MESH, mixed_stack()).key("edit", 0.0, {"frame": np.eye(4)}),
            "edits a surface: only maps of space can be placed",
        ),
    ],
)
def test_what_makes_no_sense_is_refused(call, cause):
    with pytest.raises(InvalidParameter, match=cause):
        call()
