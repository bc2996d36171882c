"""Handles of deformers along an axis: what is held stays under the pointer, and tools move as rigid things."""

from contextlib import contextmanager

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from pages import joined

import pliant as pl
from pliant.scene.kinds import all_kinds
from pliant.scene.project import load_project, save_project
from pliant.space.axial import AxialDeformer
from pliant.studio.examples.samples import bar
from pliant.studio.modes.axial.following import Ray, followed, snapped
from pliant.studio.modes.axial.ghost import ghost
from pliant.studio.modes.axial.handles import TABLE, handles_of
from pliant.studio.modes.axial.moving import moved_to, rolled_to, turned_to
from pliant.studio.modes.axial.tool import Tool, size_of

session_on = contextmanager(joined)
EYE = np.array([3.0, -9.0, 5.0])
MESH = bar()
FIELDS = {pl.Bend: {"axis": "y"}, pl.Sine: {"axis": "x", "normal": "z"}, pl.Wave: {"axis": "z"}, pl.Scale: {}}
NUMBERS = {
    "angle": 0.9, "factor": 1.35, "start": 0.7, "end": 1.4, "bulge": 0.3, "center": 0.5, "amplitude": 0.4, "waves": 1.5,
    "x": 1.3, "y": 0.8, "z": 1.6,
}  # fmt: skip


def tool_of(kind, **fields):
    deformer = kind.around(MESH, **{**FIELDS.get(kind, {"axis": "x"}), **fields})
    return Tool(deformer, size_of(deformer, MESH.points))


def towards(place, eye=EYE):
    return Ray(eye, (place - eye) / np.linalg.norm(place - eye))


def named(tool, name):
    return next(each for each in handles_of(tool) if each.name == name)


@pytest.mark.parametrize("kind", TABLE, ids=lambda kind: kind.__name__)
def test_every_number_of_the_table_is_found_where_its_handle_is_put(kind):
    for row in TABLE[kind]:
        start = tool_of(kind, **({"amplitude": 0.3} if row.name == "waves" else {}))
        wanted = row.write(start, np.array([NUMBERS[row.name]]))
        ray = towards(row.place(wanted)[0])
        assert np.linalg.norm(ray.miss(row.place(start)[0])) > 0.05 * start.size
        found = followed(start, row, ray)
        assert np.linalg.norm(ray.miss(row.place(found)[0])) < 1e-4 * start.size, row.name


@pytest.mark.parametrize("profile", ["ramp", "smooth", "constant", "bump", (1.0, 0.2)])
@pytest.mark.parametrize("kind", [pl.Twist, pl.Taper, pl.Sine, pl.Wave], ids=lambda kind: kind.__name__)
def test_a_number_is_held_where_the_profile_lets_it_act(kind, profile):
    start = tool_of(kind, profile=profile)
    row = TABLE[kind][0]
    wanted = row.write(start, np.array([NUMBERS[row.name]]))
    ray = towards(row.place(wanted)[0])
    assert np.linalg.norm(ray.miss(row.place(start)[0])) > 0.02 * start.size
    found = followed(start, row, ray)
    np.testing.assert_allclose(row.read(found), row.read(wanted), rtol=1e-3)


@pytest.mark.parametrize("kind", [kind for kind in TABLE if kind is not pl.Scale], ids=lambda kind: kind.__name__)
def test_bounds_follow_the_pointer(kind):
    start = tool_of(kind)
    for name in ("low", "high"):
        handle = named(start, name)
        middle = sum(start.deformer.bounds) / 2
        wanted = handle.write(start, handle.read(start) + 0.3 * (middle - handle.read(start)))
        found = followed(start, handle, towards(handle.place(wanted)[0]))
        np.testing.assert_allclose(found.deformer.bounds, wanted.deformer.bounds, atol=1e-6)


def test_a_twist_is_followed_through_several_turns():
    tool = tool_of(pl.Twist)
    handle, along = named(tool, "angle"), np.array([20.0, 0.0, 0.0])
    for turn in np.linspace(0, 5 * np.pi, 60)[1:]:
        goal = handle.place(handle.write(tool, np.array([turn])))[0]
        tool = followed(tool, handle, towards(goal, eye=along))
    assert tool.deformer.angle == pytest.approx(5 * np.pi, abs=1e-5)


directions = st.tuples(*[st.floats(-1, 1)] * 3).map(np.array).filter(lambda v: np.linalg.norm(v) > 0.1)


@settings(deadline=None, max_examples=60)
@given(directions)
@example(np.array([1.0, 0.0, 1.2e-7]))
@example(np.array([-1.0, 1e-6, 1e-6]))
@example(np.array([-1.0, 0.0, 0.0]))
def test_a_turned_tool_deforms_the_turned_space(tip):
    for kind, numbers in ((pl.Twist, {"angle": 1.1}), (pl.Bend, {"angle": 0.8}), (pl.Sine, {"amplitude": 0.3})):
        tool = Tool(kind.around(MESH, origin=(0.3, 0.2, -0.1), **FIELDS.get(kind, {"axis": "x"}), **numbers), 1.0)
        turned = turned_to(tool, tip)
        np.testing.assert_allclose(turned.along, tip / np.linalg.norm(tip), atol=1e-8)
        turn = turned.axes @ tool.axes.T
        if kind is pl.Twist:  # its sections have no direction of their own
            turn = _turn_between(tool.along, turned.along)
        points = MESH.points[::37] - tool.origin
        expected = tool.deformer(points + tool.origin) - tool.origin
        np.testing.assert_allclose(
            turned.deformer(points @ turn.T + tool.origin) - tool.origin, expected @ turn.T, atol=1e-6
        )


def _turn_between(first, second):
    """A rotation from one unit vector to another: half a turn about what lies in the middle."""
    middle = first + second
    if np.linalg.norm(middle) < 2e-8:
        middle = np.cross(first, np.eye(3)[np.abs(first).argmin()])
    middle = middle / np.linalg.norm(middle)
    return 2 * np.outer(middle, middle) - np.eye(3)


def test_a_moved_tool_deforms_the_moved_space():
    step = np.array([0.4, -0.3, 0.2])
    for kind, numbers in ((pl.Squash, {"factor": 1.4}), (pl.Bend, {"angle": 0.8, "center": 0.3}), (pl.Wave, {})):
        tool = tool_of(kind, **numbers)
        moved = moved_to(tool, tool.origin + step)
        expected = tool.deformer(MESH.points) + step
        np.testing.assert_allclose(moved.deformer(MESH.points + step), expected, atol=1e-9)


def test_a_rolled_bend_keeps_its_axis_and_raises_its_ends_elsewhere():
    tool = tool_of(pl.Bend, angle=1.0)
    rolled = rolled_to(tool, np.array([0.7, -1.0, 0.0]))
    np.testing.assert_allclose(rolled.along, tool.along, atol=1e-12)
    np.testing.assert_allclose(rolled.axes[:, 0], [0.0, -1.0, 0.0], atol=1e-12)
    lifted = rolled.deformer(MESH.points) - MESH.points
    assert abs(lifted[:, 2]).max() < 0.5 * abs(lifted[:, 1]).max()


def test_snapping_rounds_angles_and_finds_the_coordinate_axes():
    tool = tool_of(pl.Twist, angle=1.02 * np.pi / 3)
    assert snapped(tool, named(tool, "angle")).deformer.angle == pytest.approx(np.pi / 3)
    tilted = turned_to(tool, np.array([0.1, 0.98, 0.05]))
    assert snapped(tilted, named(tilted, "axis")).deformer.axis == "y"


def test_handles_and_lines_are_seen_through_the_layers_above():
    twist, bend = pl.Twist.around(MESH, axis="x", angle=0.7), pl.Bend.around(MESH, axis="y", angle=1.2)
    scene = pl.Scene(MESH, pl.Stack([pl.Layer("Twist", twist), pl.Layer("Bend", bend, envelope=0.5)]))
    with session_on(scene, "bar") as (session, page):
        answer = page.ask(session, "axial.get", {"layer": "Twist"})
        tool = Tool(twist, size_of(twist, MESH.points))
        places = np.concatenate([each.place(tool) for each in handles_of(tool)])
        seen = places + 0.5 * (bend(places) - places)
        np.testing.assert_allclose(answer.arrays["handles"].reshape(-1, 3), seen, atol=1e-9)
        lines = ghost(tool)
        after = lines.after + 0.5 * (bend(lines.after) - lines.after)
        np.testing.assert_allclose(answer.arrays["after"].reshape(-1, 3), after, atol=1e-5)


def test_a_drag_is_one_entry_of_the_history_and_survives_saving(tmp_path):
    with session_on(pl.Scene(MESH), "bar") as (session, page):
        page.ask(session, "layers.add", {"kind": "bend"})
        page.ask(session, "axial.fit", {"layer": "Bend", "axis": "y"})
        start = Tool(session.scene.stack["Bend"].deformer, size_of(session.scene.stack["Bend"].deformer, MESH.points))
        goal = named(start, "angle").place(start.having(angle=1.0))[0]
        ray = towards(goal)
        revision = session.revision
        page.ask(session, "axial.begin", {"layer": "Bend", "handle": "angle"})
        answer = page.ask(session, "axial.move", {"ray": [*ray.origin, *ray.direction], "snap": False})
        assert session.revision == revision
        np.testing.assert_allclose(answer.arrays["values"][0], 1.0, atol=1e-3)
        page.ask(session, "axial.commit")
        assert session.revision == revision + 1
        bend = session.scene.stack["Bend"].deformer
        np.testing.assert_allclose(session.stage.binding.result, bend(MESH.points), atol=1e-12)
        save_project(session.scene, tmp_path / "bar.pliant")
        again = load_project(tmp_path / "bar.pliant")
        np.testing.assert_allclose(again.deformed().points, session.scene.deformed().points, atol=1e-12)
        page.ask(session, "axial.begin", {"layer": "Bend", "handle": "axis"})
        page.ask(session, "axial.move", {"ray": [*ray.origin, *ray.direction], "snap": True})
        page.ask(session, "axial.cancel")
        assert session.revision == revision + 1


def test_a_placed_tool_is_held_where_it_stands():
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    frame = pl.Affine.of(1.5 * turn, [0.2, -0.3, 0.4])
    twist, bend = pl.Twist.around(MESH, axis="x", angle=0.7), pl.Bend.around(MESH, axis="y", angle=1.2)
    layers = [pl.Layer("Twist", pl.place(twist, frame), envelope=0.8), pl.Layer("Bend", bend)]
    with session_on(pl.Scene(MESH, pl.Stack(layers)), "bar") as (session, page):
        answer = page.ask(session, "axial.get", {"layer": "Twist"})
        tool = Tool(twist, size_of(twist, MESH.points), 0.8)
        places = np.concatenate([each.place(tool) for each in handles_of(tool)])
        np.testing.assert_allclose(answer.arrays["handles"].reshape(-1, 3), bend(frame(places)), atol=1e-9)
        lines = ghost(tool)
        after = pl.Stack(layers)(frame(lines.before))
        np.testing.assert_allclose(answer.arrays["after"].reshape(-1, 3), after, atol=1e-5)
        goal = bend(frame(named(tool, "angle").place(tool.having(angle=1.1))))[0]
        page.ask(session, "axial.begin", {"layer": "Twist", "handle": "angle"})
        ray = towards(goal)
        page.ask(session, "axial.move", {"ray": [*ray.origin, *ray.direction], "snap": False})
        page.ask(session, "axial.commit")
        made = session.scene.stack["Twist"].deformer
        assert made.deformer.angle == pytest.approx(1.1, abs=1e-3)
        np.testing.assert_array_equal(made.frame.matrix, frame.matrix)
        page.ask(session, "axial.fit", {"layer": "Twist"})
        fitted = session.scene.stack["Twist"].deformer
        np.testing.assert_allclose(fitted.deformer.bounds, twist.around(frame.inverse(MESH.points), axis="x").bounds)
        np.testing.assert_array_equal(fitted.frame.matrix, frame.matrix)


def test_a_normal_gives_way_to_the_axis_that_is_asked_for():
    with session_on(pl.Scene(MESH), "bar") as (session, page):
        page.ask(session, "layers.add", {"kind": "sine", "fields": {"normal": "x"}})
        page.ask(session, "axial.fit", {"layer": "Sine", "axis": "x"})
        deformer = session.scene.stack["Sine"].deformer
        assert (deformer.axis, deformer.normal) == ("x", "z")
        np.testing.assert_allclose(deformer.bounds, (-2.0, 2.0))


def test_what_has_no_axis_is_refused_by_name():
    lattice = pl.BSplineFFD.around(MESH)
    with session_on(pl.Scene(MESH, pl.Stack([pl.Layer("Lattice", lattice)])), "bar") as (session, page):
        assert "no axis" in page.refused(session, "axial.get", {"layer": "Lattice"})["message"]
        page.ask(session, "layers.add", {"kind": "taper"})
        assert (
            "there are: factor"
            in page.refused(session, "axial.begin", {"layer": "Taper", "handle": "angle"})["message"]
        )
        page.ask(session, "axial.begin", {"layer": "Taper", "handle": "factor"})
        assert "6" in page.refused(session, "axial.move", {"ray": [1, 2, 3], "snap": False})["message"]
        assert "direction" in page.refused(session, "axial.move", {"ray": [0, 0, 0, 0, 0, 0], "snap": False})["message"]


def test_every_deformer_along_an_axis_has_a_handle_for_a_number():
    own = [kind.cls for kind in all_kinds().values() if kind.cls.__module__.startswith("pliant.")]
    axial = [cls for cls in own if issubclass(cls, AxialDeformer) and cls.parameters]
    assert len(axial) >= 7
    assert [cls.__name__ for cls in axial if cls not in TABLE] == []
