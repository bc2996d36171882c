"""The session without a browser: frames, what is drawn, drags, the history, unsaved work."""

import numpy as np
import pytest
from bodies_to_edit import moved_scene, round_scene
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import pliant as pl
from pliant.numerics.coordinates.parity import inside
from pliant.scene.scene import Scene
from pliant.studio.autosave import Autosave
from pliant.studio.examples.samples import SAMPLES, ball, torus
from pliant.studio.history import MOST, Entry, History
from pliant.studio.jobs import Outdated
from pliant.studio.seen.drawn import DrawnMesh
from pliant.studio.seen.quantities import QUANTITIES
from pliant.studio.serving.frames import TYPES, Frame, MalformedFrame
from pliant.studio.session import Session

numbers = st.sampled_from(sorted(TYPES)).flatmap(
    lambda code: arrays(
        TYPES[code],
        st.integers(0, 20),
        elements={"allow_nan": False, "allow_infinity": False} if code[0] == "f" else None,
    )
)


class Page:
    """A page that remembers what it was sent."""

    def __init__(self):
        self.frames = []

    def send(self, data):
        self.frames.append(Frame.decode(data))

    def events(self, name):
        return [frame for frame in self.frames if frame.head.get("event") == name]

    def ask(self, session, command, values=None, **arrays):
        session.handle(self, Frame({"id": 1, "do": command, "with": values or {}}, arrays).encode())
        answer = self.frames[-1]
        assert "error" not in answer.head, answer.head
        return answer


@pytest.fixture
def edited():
    import pliant.studio.commands  # noqa: F401

    session, page = Session(round_scene(), "ring"), Page()
    session.join(page)
    yield session, page
    session.end()


@given(
    st.dictionaries(st.text(max_size=5), st.integers() | st.text(max_size=9), max_size=4), st.lists(numbers, max_size=4)
)
def test_a_frame_comes_back_as_it_was(head, values):
    head = {
        key: value for key, value in head.items() if key != "arrays" and (isinstance(value, str) or abs(value) < 2**53)
    }
    given_arrays = {f"a{i}": value for i, value in enumerate(values)}
    found = Frame.decode(Frame(head, given_arrays).encode())
    assert found.head == head
    for name, value in given_arrays.items():
        np.testing.assert_array_equal(found.arrays[name], value)


@given(st.binary(max_size=200))
def test_any_bytes_are_a_frame_or_are_refused(data):
    try:
        frame = Frame.decode(data)
    except MalformedFrame:
        return
    assert isinstance(frame.head, dict)


def test_normals_are_those_of_the_mesh_to_eight_bits():
    mesh = moved_scene().deformed()
    normals = DrawnMesh(mesh).normals(mesh.points) / 127.0
    # the mesh weighs polygons, the page triangles: on quadrangles of a smooth shape they differ little
    assert (np.einsum("ij,ij->i", normals, mesh.vertex_normals) > 0.97).all()
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=0.02)


def test_drawn_corners_have_the_texture_coordinates_of_the_mesh():
    mesh = torus(24, 12)
    drawn = DrawnMesh(mesh)
    arrays = drawn.arrays(mesh.points)
    source = np.concatenate([np.arange(len(mesh.points)), arrays["twins"]])
    np.testing.assert_array_equal(source[arrays["triangles"]], mesh.triangles)
    expected = mesh.uvs.per_corner[mesh.triangle_corners]
    np.testing.assert_allclose(arrays["uvs"][arrays["triangles"]], expected, atol=1e-7)
    assert len(arrays["twins"]) == 24 + 12 + 1  # the two seams


def test_what_a_drag_sends_is_the_library_s_result(edited):
    session, page = edited
    lattice = session.scene.stack["Lattice"].deformer
    page.ask(session, "drag.begin", {"layer": "Lattice"})
    told = np.array(session.scene.mesh.points)
    index = None
    for step in range(1, 4):
        target = lattice.rest[1, 2, 2] + [0, 0.02 * step, 0.1 * step]
        answer = page.ask(session, "drag.move", index=np.array([26], np.uint32), positions=target)
        index = answer.arrays.get("index", index)
        low, high = (np.array(answer.head[end]) for end in ("low", "high"))
        found = low + answer.arrays["positions"].reshape(-1, 3) / 65535 * (high - low)
        which = slice(None) if answer.head["all"] else index
        told[which] = found
        controls = np.array(lattice.rest)
        controls[1, 2, 2] = target
        expected = lattice.moved(controls)(session.scene.mesh).points
        np.testing.assert_allclose(told, expected, atol=2e-5 * session.scene.mesh.diagonal)
    assert "index" not in answer.arrays  # the same points as before: told once
    page.ask(session, "drag.commit")
    assert session.history.position == 1
    np.testing.assert_allclose(session.scene.deformed().points, expected, atol=1e-12)
    exact = page.events("points")[-1]
    np.testing.assert_allclose(
        exact.arrays["positions"].reshape(-1, 3),
        expected[exact.arrays["index"]] if "index" in exact.arrays else expected,
        atol=1e-6,
    )


def test_a_drag_that_is_given_up_leaves_nothing(edited):
    session, page = edited
    before = session.scene
    page.ask(session, "drag.begin", {"layer": "Lattice"})
    page.ask(session, "drag.move", index=np.array([0], np.uint32), positions=np.array([9.0, 9, 9]))
    page.ask(session, "drag.cancel")
    assert session.scene is before
    restored = page.events("points")[-1]
    where = restored.arrays.get("index", np.arange(len(before.mesh.points)))
    np.testing.assert_allclose(restored.arrays["positions"].reshape(-1, 3), before.mesh.points[where], atol=1e-6)


def test_a_layer_without_control_points_has_none_to_drag(edited):
    session, page = edited
    layer = page.ask(session, "layers.add", {"kind": "twist"}).head["layer"]
    session.handle(page, Frame({"id": 1, "do": "drag.begin", "with": {"layer": layer}}, {}).encode())
    assert "no control points" in page.frames[-1].head["error"]["message"]
    assert session.dragging is None


def test_locked_points_stay(edited):
    session, page = edited
    page.ask(session, "points.lock", {"layer": "Lattice", "locked": True}, index=np.array([5], np.uint32))
    page.ask(session, "drag.begin", {"layer": "Lattice"})
    page.ask(session, "drag.move", index=np.array([5, 6], np.uint32), positions=np.full(6, 0.5))
    page.ask(session, "drag.commit")
    moved = np.linalg.norm(session.scene.stack["Lattice"].deformer.displacements, axis=-1).reshape(-1)
    assert np.flatnonzero(moved).tolist() == [6]


def test_a_pulled_point_arrives(edited):
    session, page = edited
    mesh = session.scene.mesh
    triangle = mesh.triangles[100]
    point = mesh.points[triangle].mean(axis=0)
    goal = point + [0.05, 0.1, -0.02]
    page.ask(session, "pull.begin", {"layer": "Lattice", "triangle": triangle.tolist(), "point": point.tolist()})
    page.ask(session, "pull.move", goal=goal)
    page.ask(session, "pull.commit")
    np.testing.assert_allclose(session.scene.deformed().points[triangle].mean(axis=0), goal, atol=2e-3)


def test_a_slider_previews_what_it_commits(edited):
    session, page = edited
    page.ask(session, "layers.add", {"kind": "twist"})
    page.ask(session, "preview.begin", {"layer": "Twist", "label": "field"})
    for angle in (0.3, 0.7):
        page.ask(session, "preview.move", {"fields": {"angle": angle}})
    page.ask(session, "preview.commit")
    assert session.scene.stack["Twist"].deformer.angle == 0.7
    assert [entry.key for entry in session.history.entries] == ["open", "add", "field"]


@pytest.mark.parametrize("name", sorted(QUANTITIES))
def test_quantities_at_rest_are_nothing_and_fit_their_colours(edited, name):
    session, page = edited
    answer = page.ask(session, "field.color", {"quantity": name})
    expected = 1.0 if name == "volume ratio" else 0.0
    np.testing.assert_allclose(answer.arrays["values"], expected, atol=1e-6)
    assert answer.head["low"] < answer.head["high"]
    assert len(answer.arrays["table"]) == 768


def test_every_kind_that_the_page_offers_can_be_added(edited):
    session, page = edited
    for kind in page.events("hello")[0].head["catalogue"]["kinds"]:
        page.ask(session, "layers.add", {"kind": kind["name"]})
    names = session.scene.stack.names
    assert len(names) > 10
    np.testing.assert_allclose(session.scene.deformed().points, session.scene.mesh.points, atol=1e-9)


def test_grid_lines_inside_only_are_inside(edited):
    session, page = edited
    answer = page.ask(session, "field.lines", {"density": 10, "slice": "box", "inside": True})
    points = answer.arrays["points"].reshape(-1, 3)
    ring = np.hypot(np.linalg.norm(points[:, :2], axis=1) - 1.0, points[:, 2])
    assert len(points) > 100
    assert (ring < 0.385).all()


def test_inside_is_what_a_sphere_says(random):
    mesh = ball(128, 64)
    points = random.uniform(-1.2, 1.2, (4000, 3))
    far = np.abs(np.linalg.norm(points, axis=1) - 1) > 0.01
    far &= np.abs(points[:, 2]) < 0.98  # the caps are flat
    expected = np.linalg.norm(points, axis=1) < 1
    np.testing.assert_array_equal(inside(points, mesh.points, mesh.triangles)[far], expected[far])


@pytest.mark.parametrize("name", sorted(SAMPLES))
def test_samples_are_closed_and_face_outwards(name):
    mesh = SAMPLES[name].make()
    assert len(mesh.points) == SAMPLES[name].points
    assert mesh.edge_use == (0, 0)
    assert pl.volume(mesh) > 0


def test_the_history_forgets_the_oldest_and_what_was_undone():
    scene = Scene(ball(8, 6))
    history = History(Entry(scene, "open"))
    for step in range(MOST + 5):
        history.push(Entry(scene, "drag", str(step)))
    assert len(list(history.entries)) == MOST
    history.go(3)
    history.push(Entry(scene, "new"))
    assert len(list(history.entries)) == 5
    assert not history.go(5)


def test_unsaved_work_comes_back_with_its_texture(tmp_path):
    scene = round_scene()
    first = Autosave(tmp_path, delay=60)
    first.keep(scene, "ring")
    first.finish()
    second = Autosave(tmp_path)
    (entry,) = second.recoverable()
    again = pl.load_project(second.place(entry["name"]))
    np.testing.assert_array_equal(again.mesh.points, scene.mesh.points)
    assert again.mesh.material_library["checkers"].texture.is_file()
    second.recovered(entry["name"])
    assert second.recoverable() == []
    assert list(tmp_path.iterdir()) == []
    second.finish()


def test_a_widget_gives_its_stack_back():
    from pliant.studio.widget import Widget

    scene = round_scene()
    widget = Widget(scene.mesh, scene.stack)
    sent = []
    widget.send = lambda content, buffers=None: sent.append(Frame.decode(buffers[0]))
    widget._receive(widget, {"hello": True}, [])
    assert [frame.head["event"] for frame in sent] == ["hello", "scene", "mesh", "fold"]
    values = {"layer": "Lattice"}
    arrays = {"index": np.array([0], np.uint32), "positions": np.array([9.0, 8, 7])}
    widget._receive(widget, {"frame": True}, [Frame({"id": 4, "do": "points.set", "with": values}, arrays).encode()])
    assert widget.stack["Lattice"].deformer.controls[0, 0, 0].tolist() == [9, 8, 7]
    assert sent[-1].head == {"answer": 4}


def test_a_proof_tells_how_far_it_is_and_an_outdated_one_ends():
    mesh = ball()
    lattice = pl.BSplineFFD.around(mesh, shape=(5, 5, 5))
    noise = np.random.default_rng(1).normal(size=lattice.rest.shape)
    scene = pl.Scene(mesh, pl.Stack([pl.Layer("Lattice", lattice.moved(lattice.rest + 0.1 * noise))]))
    session, page = Session(scene, "ball"), Page()
    session.join(page)
    session.submit(session.jobs.look_for_folds).result()
    session.jobs._pool.submit(lambda: None).result()  # the proof has ended
    session.submit(lambda: None).result()  # and all that it told has been sent
    told = [frame.head["fold"] for frame in page.events("fold")]
    begun = max(at for at, fold in enumerate(told) if fold == {"status": "checking"})
    parts = [fold["part"] for fold in told[begun:] if "part" in fold]
    assert len(parts) > 1
    assert parts == sorted(parts)
    assert told[-1]["status"] in ("fold-free", "folds", "undecided")
    with pytest.raises(Outdated):
        session.jobs._looked(session.jobs._looking - 1, 0.5)
    session.end()
