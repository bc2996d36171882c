"""Time without a browser: the playhead, keys that edits set, keys that are edited, undo, and the project file."""

import numpy as np
import pytest
from bodies_to_edit import round_scene
from pages import Page, joined

import pliant as pl
from pliant.scene.scene import Scene
from pliant.studio.examples.samples import bar
from pliant.studio.modes.clip_state import track_state
from pliant.studio.session import Session


def bent_scene():
    """A bar under a bend whose angle grows for two seconds."""
    mesh = bar(along=24, across=4)
    stack = pl.Stack([pl.Layer("Bend", pl.Bend.around(mesh, axis="y", angle=0.0))])
    clip = pl.Clip(mesh, stack, duration=2.0, fps=10.0)
    clip = clip.key("Bend", 0.0, {"angle": 0.0}).key("Bend", 2.0, {"angle": 1.5}, easing="ease_in_out")
    return Scene(mesh, stack, clip)


@pytest.fixture
def moving():
    yield from joined(bent_scene(), "bar")


@pytest.fixture
def still():
    yield from joined(round_scene(), "ring")


def clip_told(page):
    return page.events("scene")[-1].head["scene"]["clip"]


def test_the_playhead_shows_the_clip_as_the_library_samples_it(moving):
    session, page = moving
    revision = session.revision
    for time in (0.7, 2.0, 0.0, 1.3):
        page.ask(session, "time.goto", {"time": time})
        np.testing.assert_allclose(session.shown.told, bent_scene().clip.sample(time).points, atol=1e-12)
        assert clip_told(page)["time"] == time
    assert session.revision == revision  # looking is no change
    layer = page.events("scene")[-1].head["scene"]["layers"][0]
    angle = next(field["value"] for field in layer["fields"] if field["name"] == "angle")
    assert angle == pytest.approx(bent_scene().clip.stack_at(1.3)["Bend"].deformer.angle)  # panels follow


def test_a_moment_is_sent_without_being_kept(moving):
    session, page = moving
    answer = page.ask(session, "time.frame", {"time": 1.1})
    low, high = np.array(answer.head["low"]), np.array(answer.head["high"])
    found = low + answer.arrays["positions"].reshape(-1, 3) / 65535 * (high - low)
    np.testing.assert_allclose(found, bent_scene().clip.sample(1.1).points, atol=1e-4)
    assert session.time == 0.0


def test_editing_a_value_that_has_keys_sets_one_at_the_playhead(moving):
    session, page = moving
    page.ask(session, "time.goto", {"time": 1.0})
    page.ask(session, "layers.fields", {"layer": "Bend", "fields": {"angle": -0.5}})
    (track,) = session.scene.clip.tracks
    assert [(key.time, float(key.value)) for key in track.keys] == [(0.0, 0.0), (1.0, -0.5), (2.0, 1.5)]
    np.testing.assert_allclose(session.shown.told, session.scene.clip.sample(1.0).points, atol=1e-12)
    page.ask(session, "layers.envelope", {"layer": "Bend", "envelope": 0.5})  # which has none
    assert len(session.scene.clip.tracks) == 1
    page.ask(session, "history.undo")
    page.ask(session, "history.undo")
    assert [key.time for key in session.scene.clip.tracks[0].keys] == [0.0, 2.0]
    np.testing.assert_allclose(session.shown.told, bent_scene().clip.sample(1.0).points, atol=1e-12)


def test_while_recording_a_drag_of_control_points_sets_a_key_and_keeps_the_beginning(still):
    session, page = still
    rest = session.scene.stack["Lattice"].deformer.controls.copy()
    page.ask(session, "time.record", {"on": True})
    page.ask(session, "time.goto", {"time": 1.5})
    page.ask(session, "drag.begin", {"layer": "Lattice"})
    goal = np.array([2.0, 2.0, 1.0])
    page.ask(session, "drag.move", index=np.array([63], np.uint32), positions=goal)
    page.ask(session, "drag.commit")
    (track,) = session.scene.clip.tracks
    assert (track.field, [key.time for key in track.keys]) == ("controls", [0.0, 1.5])
    np.testing.assert_array_equal(track.keys[0].value, rest)
    np.testing.assert_array_equal(np.asarray(track.keys[1].value)[3, 3, 3], goal)
    page.ask(session, "time.goto", {"time": 0.0})
    np.testing.assert_allclose(session.shown.told, session.scene.mesh.points, atol=1e-12)


def test_keys_are_moved_doubled_eased_and_removed(moving):
    session, page = moving
    page.ask(session, "keys.begin", {"keys": [["Bend", "angle", 2.0]]})
    page.ask(session, "time.frame", {"time": 0.3})
    answer = page.ask(session, "keys.move", {"by": -0.5, "rise": 45.0})
    assert [key["time"] for key in answer.head["tracks"][0]["keys"]] == [0.0, 1.5]
    page.ask(session, "keys.commit")
    key = session.scene.clip.tracks[0].keys[-1]
    assert (key.time, float(key.value), key.easing) == (1.5, pytest.approx(1.5 + np.pi / 4), "ease_in_out")
    page.ask(session, "time.goto", {"time": 0.5})
    page.ask(session, "time.double", {"keys": [["Bend", "angle", 0.0], ["Bend", "angle", 1.5]]})
    assert [key.time for key in session.scene.clip.tracks[0].keys] == [0.0, 0.5, 1.5, 2.0]
    page.ask(session, "time.ease", {"keys": [["Bend", "angle", 2.0]], "easing": [0.2, 0.0, 0.4, 1.3]})
    assert session.scene.clip.tracks[0].keys[-1].easing == (0.2, 0.0, 0.4, 1.3)
    page.ask(session, "time.remove", {"keys": [["Bend", "angle", 0.5], ["Bend", "angle", 1.5]]})
    assert [key.time for key in session.scene.clip.tracks[0].keys] == [0.0, 2.0]


def test_a_drag_of_keys_shows_the_shape_at_the_playhead(moving):
    session, page = moving
    page.ask(session, "time.goto", {"time": 1.0})
    page.ask(session, "keys.begin", {"keys": [["Bend", "angle", 2.0]]})
    answer = page.ask(session, "keys.move", {"easing": [0.0, 1.0, 0.0, 1.0]})
    low, high = np.array(answer.head["low"]), np.array(answer.head["high"])
    found = low + answer.arrays["positions"].reshape(-1, 3) / 65535 * (high - low)
    expected = bent_scene().clip.key("Bend", 2.0, {"angle": 1.5}, easing=(0.0, 1.0, 0.0, 1.0)).sample(1.0).points
    np.testing.assert_allclose(found, expected, atol=1e-4)
    page.ask(session, "keys.cancel")
    np.testing.assert_allclose(session.shown.points, bent_scene().clip.sample(1.0).points, atol=1e-12)


def test_drawn_curves_are_the_library_s_own():
    for easing in ("step", "linear", "cubic", "bounce", "elastic", (0.3, -0.4, 0.6, 1.5)):
        clip = bent_scene().clip.key("Bend", 1.2, {"angle": -0.4}, easing=easing)
        (track,) = clip.tracks
        told = track_state(clip, track)
        expected = [180 / np.pi * float(track.at(time)) for time in told["times"]]
        jumps = np.isclose(told["times"], 1.2)  # a step's two ends are told at one time
        np.testing.assert_allclose(np.array(told["curves"][0])[~jumps], np.array(expected)[~jumps], atol=1e-3)


def test_the_clip_s_own_numbers(moving):
    session, page = moving
    page.ask(session, "time.clip", {"fps": 60, "ending": "ping-pong"})
    page.ask(session, "time.clip", {"duration": 1.0, "stretch": True})
    clip = session.scene.clip
    assert (clip.fps, clip.ending, clip.duration, clip.period) == (60.0, "ping-pong", 1.0, 2.0)
    assert [key.time for key in clip.tracks[0].keys] == [0.0, 1.0]
    page.ask(session, "time.goto", {"time": 1.75})
    np.testing.assert_allclose(session.shown.told, clip.sample(0.25).points, atol=1e-12)  # on the way back


def test_the_playhead_stays_within_the_clip(moving):
    session, page = moving
    page.ask(session, "time.goto", {"time": 1.8})
    page.ask(session, "time.clip", {"duration": 0.5})
    assert session.time == clip_told(page)["time"] == 0.5
    np.testing.assert_allclose(session.shown.told, session.scene.clip.sample(0.5).points, atol=1e-12)
    page.ask(session, "history.undo")
    np.testing.assert_allclose(session.shown.told, bent_scene().clip.sample(0.5).points, atol=1e-12)


def test_keys_follow_a_layer_that_is_renamed_and_go_with_one_that_is_removed(moving):
    session, page = moving
    page.ask(session, "layers.rename", {"layer": "Bend", "name": "Curl"})
    assert [track.layer for track in session.scene.clip.tracks] == ["Curl"]
    page.ask(session, "layers.remove", {"layer": "Curl"})
    assert session.scene.clip.tracks == ()
    page.ask(session, "history.undo")
    assert [track.layer for track in session.scene.clip.tracks] == ["Curl"]


def test_a_scene_with_a_clip_survives_its_project_file(moving, tmp_path):
    session, page = moving
    page.ask(session, "time.clip", {"ending": "loop"})
    page.ask(session, "time.goto", {"time": 0.5})
    answer = page.ask(session, "project.save")
    path = tmp_path / "bar.pliant"
    path.write_bytes(answer.arrays["file"].tobytes())
    again = Session(pl.load_project(path), "bar")
    clip = again.scene.clip
    assert (clip.duration, clip.fps, clip.ending) == (2.0, 10.0, "loop")
    for time in (0.0, 0.9, 1.7):
        np.testing.assert_allclose(clip.sample(time).points, bent_scene().clip.sample(time).points, atol=1e-12)
    other = Page()
    again.join(other)
    assert len(clip_told(other)["tracks"][0]["keys"]) == 2
    again.end()


@pytest.mark.parametrize(
    ("command", "values"),
    [
        ("time.goto", {"time": "soon"}),
        ("time.clip", {"duration": -1.0}),
        ("time.clip", {"ending": "never"}),
        ("time.clip", {"fps": 1e9}),
        ("time.key", {"layer": "Bend", "fields": ["colour"]}),
        ("time.key", {"layer": "Bow", "fields": ["angle"]}),
        ("time.remove", {"keys": []}),
        ("time.remove", {"keys": [["Bend", "angle", 0.123]]}),
        ("time.ease", {"keys": [["Bend", "angle", 2.0]], "easing": [2, 0, 0, 0]}),
        ("time.ease", {"keys": [["Bend", "angle", 2.0]], "easing": "sudden"}),
        ("keys.begin", {"keys": [[1, 2]]}),
    ],
)
def test_what_makes_no_sense_is_refused_and_changes_nothing(moving, command, values):
    session, page = moving
    revision = session.revision
    error = page.refused(session, command, values)
    assert error["kind"] != "Bug"
    assert session.revision == revision


def test_placing_a_tool_sets_keys_and_the_clip_moves_it_as_the_library_does(still):
    session, page = still
    lattice = session.scene.stack["Lattice"].deformer
    controls = np.array(lattice.rest)
    controls[1, 1, 1] += [0.0, 0.0, 0.5]
    page.ask(session, "points.set", {"layer": "Lattice"}, index=np.array([21], np.uint32), positions=controls[1, 1, 1])
    page.ask(session, "time.goto", {"time": 2.0})
    move = pl.Affine.rotation("z", 0.8) @ pl.Affine.translation([0.3, 0.0, 0.0])
    page.ask(session, "place.begin", {"layer": "Lattice"})
    page.ask(session, "place.move", {"matrix": move.matrix.reshape(-1).tolist()})
    page.ask(session, "place.commit")
    (track,) = session.scene.clip.tracks
    assert (track.field, [key.time for key in track.keys]) == ("frame", [0.0, 2.0])
    mesh, tool = session.scene.mesh, lattice.moved(controls)
    np.testing.assert_allclose(session.shown.told, pl.place(tool, move)(mesh).points, atol=1e-12)
    page.ask(session, "time.goto", {"time": 0.0})
    np.testing.assert_allclose(session.shown.told, tool(mesh).points, atol=1e-12)
    answer = page.ask(session, "place.get", {"layer": "Lattice"})
    way, pivot = answer.arrays["way"].reshape(-1, 3), np.array(answer.head["pivot"])
    np.testing.assert_allclose(way[0], pivot, atol=1e-12)
    np.testing.assert_allclose(way[-1], move(pivot[None])[0], atol=1e-12)


def test_control_points_of_a_tool_elsewhere_are_seen_and_dragged_where_they_are(still):
    session, page = still
    move = pl.Affine.translation([0.0, 0.0, 0.7])
    page.ask(session, "place.begin", {"layer": "Lattice"})
    page.ask(session, "place.move", {"matrix": move.matrix.reshape(-1).tolist()})
    page.ask(session, "place.commit")
    seen = page.ask(session, "points.get", {"layer": "Lattice"}).arrays["points"].reshape(-1, 3)
    rest = session.scene.stack["Lattice"].deformer.rest.reshape(-1, 3)
    np.testing.assert_allclose(seen, rest + [0.0, 0.0, 0.7], atol=1e-12)
    goal = seen[5] + [0.1, 0.2, 0.3]
    page.ask(session, "drag.begin", {"layer": "Lattice"})
    page.ask(session, "drag.move", index=np.array([5], np.uint32), positions=goal)
    page.ask(session, "drag.commit")
    after = page.ask(session, "points.get", {"layer": "Lattice"}).arrays["points"].reshape(-1, 3)
    np.testing.assert_allclose(after[5], goal, atol=1e-12)


def test_the_object_moves_through_the_tool(moving):
    session, page = moving
    layer = page.ask(session, "place.through", {"layer": "Bend"}).head["layer"]
    assert session.scene.stack.names == (layer, "Bend")
    page.ask(session, "time.goto", {"time": 2.0})
    page.ask(session, "place.begin", {"layer": layer})
    move = pl.Affine.translation([1.0, 0.0, 0.0])
    page.ask(session, "place.move", {"matrix": move.matrix.reshape(-1).tolist()})
    page.ask(session, "place.commit")
    mesh, bend = session.scene.mesh, bent_scene().clip.stack_at(2.0)["Bend"].deformer
    np.testing.assert_allclose(session.shown.told, bend(move(mesh)).points, atol=1e-12)
    page.ask(session, "time.goto", {"time": 1.0})
    half = pl.Affine.translation([session.scene.stack[layer].deformer.offset[0], 0.0, 0.0])
    bend = bent_scene().clip.stack_at(1.0)["Bend"].deformer
    np.testing.assert_allclose(session.shown.told, bend(half(mesh)).points, atol=1e-12)
    assert 0 < half.offset[0] < 1


def test_a_placed_tool_keeps_its_properties(moving):
    session, page = moving
    page.ask(session, "place.begin", {"layer": "Bend"})
    page.ask(session, "place.move", {"matrix": pl.Affine.translation([0.0, 1.0, 0.0]).matrix.reshape(-1).tolist()})
    page.ask(session, "place.commit")
    told = page.events("scene")[-1].head["scene"]["layers"][0]
    assert told["kind"] == "bend"
    page.ask(session, "layers.fields", {"layer": "Bend", "fields": {"angle": 0.3}})
    assert session.scene.stack["Bend"].deformer.deformer.angle == 0.3
