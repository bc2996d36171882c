"""Surface editing without a browser: what a page picks and drags is what the library finds and computes."""

import time
from threading import Event

import numpy as np
import pytest
from pages import Page

import pliant as pl
from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.studio.examples.samples import bar, torus
from pliant.studio.session import Session
from pliant.surface import regions
from pliant.surface.screen import in_brush, in_lasso

BAR = bar()
X = BAR.points[:, 0]
REGION, HANDLE = np.flatnonzero(X > -0.5), np.flatnonzero(X > 1.8)
CAMERA = np.array([[0.4, 0, 0, 0], [0, 0, 0.8, 0], [0, 0.4, 0, 0], [0, 0, 0, 1.0]])  # from -y, straight on
METHODS = {"laplacian": pl.LaplacianEdit, "arap": pl.ARAP, "skeleton": pl.SkeletonEdit}


@pytest.fixture
def edited():
    import pliant.studio.commands  # noqa: F401

    opened = []

    def begin(scene):
        session, page = Session(scene, "bar"), Page()
        session.join(page)
        opened.append(session)
        return session, page

    yield begin
    for session in opened:
        session.end()


def turn(angle, axis=1, shift=(0.0, 0.0, 0.0)):
    """A map as pages send it: columns one after another."""
    matrix = np.eye(4)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[j, i] = np.sin(angle)
    matrix[i, j] = -matrix[j, i]
    matrix[:3, 3] = shift
    return matrix


def sent(matrix):
    return matrix.T.reshape(-1).copy()


def moved(points, matrix):
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def begun(session, page, method="laplacian", layer=""):
    structure = {} if layer else {"region": REGION.astype(np.uint32), "handle": HANDLE.astype(np.uint32)}
    return page.ask(session, "surface.begin", {"layer": layer, "method": method}, **structure).head["layer"]


def test_what_is_picked_is_what_the_library_finds(edited):
    session, page = edited(Scene(BAR))
    outline = np.array([[-0.5, -0.5], [0.6, -0.4], [0.1, 0.7]])
    for visible in (False, True):
        view = {"camera": sent(CAMERA)}
        found = page.ask(session, "surface.within", {"visible": visible}, outline=outline.reshape(-1), **view)
        assert found.arrays["index"].tolist() == in_lasso(BAR, CAMERA, outline, visible=visible).tolist()
        stroke = {"visible": visible, "wide": 0.05, "high": 0.1}
        found = page.ask(session, "surface.brush", stroke, path=outline.reshape(-1), **view)
        expected = in_brush(BAR, CAMERA, outline, (0.05, 0.1), visible=visible)
        assert found.arrays["index"].tolist() == expected.tolist()
    start = np.array([7], np.uint32)
    away = page.ask(session, "surface.distances", index=start).arrays["distances"]
    assert np.flatnonzero(away <= 1.3).tolist() == regions.geodesic_ball(BAR, [7], 1.3).tolist()
    for rings in (2, -3):
        grown = page.ask(session, "surface.grow", {"rings": rings}, index=REGION.astype(np.uint32)).arrays["index"]
        assert grown.tolist() == regions.grow(BAR, REGION, rings).tolist()


def test_large_shapes_are_measured_in_the_background(edited, monkeypatch):
    from pliant.studio.commands import surface

    session, page = edited(Scene(BAR))
    page.ask(session, "surface.measure")
    assert "along" not in session.beside  # a small one is measured when it is asked for
    monkeypatch.setattr(surface, "_MANY", 100)
    page.ask(session, "surface.measure")
    session.jobs._pool.submit(lambda: None).result()
    _, along = session.beside["along"]
    assert along.ready
    away = page.ask(session, "surface.distances", index=np.array([7], np.uint32)).arrays["distances"]
    assert session.beside["along"][1] is along
    np.testing.assert_allclose(away, regions.geodesic_distance(BAR.points, BAR.triangles, np.array([7])), rtol=1e-6)


def test_picking_is_of_the_shape_as_it_is_seen(edited):
    shift = pl.Affine.translation([1.0, 0, 0])
    session, page = edited(Scene(BAR, Stack((Layer("Shift", shift),))))
    outline = np.array([[0.0, -1.0], [1.0, -1.0], [1.0, 1.0], [0.0, 1.0]]).reshape(-1)
    found = page.ask(session, "surface.within", {"visible": False}, outline=outline, camera=sent(CAMERA))
    assert found.arrays["index"].tolist() == np.flatnonzero((X + 1 >= 0) & (X + 1 < 2.5)).tolist()


@pytest.mark.parametrize("method", METHODS)
def test_a_drag_is_one_layer_that_the_library_computes_alike(edited, method):
    session, page = edited(Scene(BAR))
    matrix = turn(0.4, shift=(0.0, 0.1, 0.3))
    layer = begun(session, page, method)
    page.ask(session, "surface.move", matrix=sent(turn(0.2)))
    page.ask(session, "surface.move", matrix=sent(matrix))
    page.ask(session, "surface.commit")
    assert len(session.history.entries) == 2
    goal = moved(BAR.points[HANDLE], matrix)
    expected = METHODS[method](REGION, HANDLE, goal=goal)
    made = session.scene.stack[layer].deformer
    assert type(made) is METHODS[method]
    np.testing.assert_allclose(made.goal, goal, atol=1e-12)
    np.testing.assert_allclose(session.shown.binding.result, expected(BAR).points, atol=1e-9)
    page.ask(session, "history.undo")
    assert not len(session.scene.stack)


def test_arap_converges_while_the_handle_rests_and_methods_are_switched_on_the_same_drag(edited):
    session, page = edited(Scene(BAR))
    begun(session, page, "laplacian")
    matrix = turn(0.9, shift=(0.0, 0.0, 0.4))
    page.ask(session, "surface.move", matrix=sent(matrix))
    answer = page.ask(session, "surface.move", {"method": "arap"})
    energies = answer.arrays["energies"].tolist()
    while not answer.arrays["converged"][0]:
        answer = page.ask(session, "surface.move")
        energies += answer.arrays["energies"].tolist()
    assert (np.diff(energies) <= 1e-9 * energies[0]).all()  # a drag goes on where it was
    goal = moved(BAR.points[HANDLE], matrix)
    best = pl.ARAP(REGION, HANDLE).bind(BAR).solve(goal).energy
    assert energies[-1] <= 1.02 * best
    np.testing.assert_allclose(session.dragging._drag.points[HANDLE], goal, atol=1e-12)
    page.ask(session, "surface.move", {"method": "skeleton"})
    expected = pl.SkeletonEdit(REGION, HANDLE, goal=goal)(BAR).points
    np.testing.assert_allclose(session.dragging._drag.points, expected, atol=1e-9)
    page.ask(session, "surface.cancel")
    assert not len(session.scene.stack)
    np.testing.assert_array_equal(session.shown.binding.result, BAR.points)


def test_a_handle_goes_where_it_is_dragged_above_layers_that_turn_it(edited):
    bend = turn(0.7, axis=2, shift=(0.3, 0.0, 0.0))
    session, page = edited(Scene(BAR, Stack((Layer("Turn", pl.Affine(bend)),))))
    before = session.shown.binding.result[HANDLE].copy()
    layer = begun(session, page)
    matrix = turn(0.3, shift=(0.0, 0.2, 0.5))
    page.ask(session, "surface.move", matrix=sent(matrix))
    page.ask(session, "surface.commit")
    np.testing.assert_allclose(session.shown.binding.result[HANDLE], moved(before, matrix), atol=1e-9)
    again = turn(-0.2, shift=(0.1, 0.0, -0.2))  # the same layer goes on from there
    begun(session, page, layer=layer)
    page.ask(session, "surface.move", matrix=sent(again))
    page.ask(session, "surface.commit")
    np.testing.assert_allclose(session.shown.binding.result[HANDLE], moved(moved(before, matrix), again), atol=1e-9)
    assert session.scene.stack.names == ("Turn", layer)


def test_another_region_keeps_the_handle_where_the_edit_has_put_it(edited):
    session, page = edited(Scene(BAR))
    layer = begun(session, page)
    page.ask(session, "surface.move", matrix=sent(turn(0.5)))
    page.ask(session, "surface.commit")
    was = session.shown.binding.result.copy()
    wider, larger = np.flatnonzero(X > -1), np.flatnonzero(X > 1.5)
    arrays = {"region": wider.astype(np.uint32), "handle": larger.astype(np.uint32)}
    page.ask(session, "surface.restructure", {"layer": layer}, **arrays)
    np.testing.assert_allclose(session.shown.binding.result[larger], was[larger], atol=1e-12)
    told = page.ask(session, "surface.region", {"layer": layer})
    assert told.arrays["region"].tolist() == wider.tolist()
    assert told.arrays["handle"].tolist() == larger.tolist()
    page.ask(session, "surface.method", {"layer": layer, "method": "arap"})
    expected = pl.ARAP(wider, larger, goal=was[larger])(BAR).points
    np.testing.assert_allclose(session.shown.binding.result, expected, atol=1e-12)


def test_named_selections_and_edits_are_saved_with_the_scene(edited, tmp_path):
    session, page = edited(Scene(BAR))
    page.ask(session, "surface.keep", {"name": "tip"}, index=HANDLE.astype(np.uint32))
    assert page.ask(session, "surface.part", {"part": "tip"}).arrays["index"].tolist() == HANDLE.tolist()
    begun(session, page, "arap")
    page.ask(session, "surface.move", matrix=sent(turn(0.3)))
    page.ask(session, "surface.commit")
    file = page.ask(session, "project.save").arrays["file"]
    (tmp_path / "bar.pliant").write_bytes(file.tobytes())
    again = pl.load_project(tmp_path / "bar.pliant")
    assert again.selections["tip"].tolist() == HANDLE.tolist()
    np.testing.assert_allclose(again.deformed().points, session.shown.binding.result, atol=1e-12)
    page.ask(session, "surface.forget", {"name": "tip"})
    assert not session.scene.selections


def test_the_skeleton_goes_along_with_a_drag(edited):
    session, page = edited(Scene(BAR))
    assert not page.ask(session, "surface.skeleton", {"contours": 12}).head["known"]
    session.jobs._pool.submit(lambda: None).result()
    session.submit(lambda: None).result()
    told = page.events("skeleton")[-1]
    expected = pl.contour_skeleton(BAR, contours=12)
    np.testing.assert_allclose(told.arrays["points"].reshape(-1, 3), expected.points, atol=1e-9)
    assert told.arrays["groups"].tolist() == expected.groups.tolist()
    begun(session, page)
    answer = page.ask(session, "surface.move", matrix=sent(turn(0.3)))
    now = session.dragging._drag.points
    np.testing.assert_allclose(
        answer.arrays["skeleton"].reshape(-1, 3), expected.following(now - BAR.points), atol=1e-12
    )


@pytest.mark.parametrize(
    ("command", "values", "arrays", "cause"),
    [
        ("surface.within", {"visible": True}, {"outline": np.zeros(6), "camera": np.zeros(3)}, "16 numbers"),
        ("surface.within", {"visible": True}, {"outline": np.zeros(5), "camera": np.eye(4)}, "two a place"),
        (
            "surface.brush",
            {"visible": True, "wide": 0, "high": 1},
            {"path": np.zeros(2), "camera": np.eye(4)},
            "positive",
        ),
        (
            "surface.brush",
            {"visible": True, "wide": "a", "high": 1},
            {"path": np.zeros(2), "camera": np.eye(4)},
            "wide",
        ),
        ("surface.distances", {}, {"index": np.zeros(0, np.uint32)}, "no vertex"),
        ("surface.keep", {"name": " "}, {"index": np.zeros(1, np.uint32)}, "needs a name"),
        ("surface.forget", {"name": "none"}, {}, "no selection"),
        ("surface.region", {"layer": "Shift"}, {}, "no region"),
        ("surface.begin", {"method": "magic"}, {"region": HANDLE, "handle": HANDLE}, "no method"),
        ("surface.begin", {"method": "arap"}, {"region": REGION, "handle": HANDLE[:0]}, "handle is empty"),
        ("surface.begin", {"method": "arap"}, {"region": HANDLE, "handle": REGION}, "lie outside"),
        ("surface.begin", {"method": "arap", "layer": "Shift"}, {}, "no region"),
        ("surface.move", {}, {"matrix": np.eye(4)}, "no drag"),
        ("surface.skeleton", {"contours": 0}, {}, "contours"),
    ],
)
def test_bad_requests_are_refused(edited, command, values, arrays, cause):
    session, page = edited(Scene(BAR, Stack((Layer("Shift", pl.Affine.translation([1.0, 0, 0])),))))
    flat = {name: np.asarray(array).reshape(-1) for name, array in arrays.items()}
    flat = {name: array.astype(np.uint32) if array.dtype.kind == "i" else array for name, array in flat.items()}
    assert cause in page.refused(session, command, values, **flat)["message"]
    assert session.dragging is None


def test_a_number_that_64_bits_do_not_hold_is_refused(edited):
    session, page = edited(Scene(BAR))
    for rings in (1 << 63, (1 << 64) - 1):
        told = page.refused(session, "surface.grow", {"rings": rings}, index=REGION.astype(np.uint32))
        assert told["kind"] == "InvalidParameter"


def large_ring(around=72):
    """A region of more than two thousand vertices, and a handle on its far side."""
    ring = torus(around=around, across=36)
    x = ring.points[:, 0]
    return ring, np.flatnonzero(x > x.min() + 0.2), np.flatnonzero(x > x.max() - 0.15)


def let_go(session, page, handle, region):
    structure = {"region": region.astype(np.uint32), "handle": handle.astype(np.uint32)}
    layer = page.ask(session, "surface.begin", {"method": "arap"}, **structure).head["layer"]
    page.ask(session, "surface.move", matrix=sent(turn(0.8, shift=(0.0, 0.0, 0.5))))
    shown = np.array(session.dragging._drag.points)
    page.ask(session, "surface.commit")
    return layer, shown


def settled(session, page):
    """Wait for what is iterated in the background."""
    end = time.monotonic() + 60
    while not page.events("progress-end"):
        assert time.monotonic() < end
        time.sleep(0.01)
    session.worker.submit(lambda: None).result()


def test_a_large_edit_is_let_go_at_once_and_iterated_to_its_end_in_the_background(edited):
    ring, region, handle = large_ring()
    session, page = edited(Scene(ring))
    held = Event()
    session.jobs._pool.submit(held.wait, 60)
    layer, shown = let_go(session, page, handle, region)
    assert len(session.history.entries) == 2
    np.testing.assert_allclose(session.shown.binding.result, shown, rtol=0, atol=1e-12)  # nothing jumps
    drawn = len(page.events("points"))
    held.set()
    settled(session, page)
    assert len(page.events("points")) > drawn
    made = session.scene.stack[layer].deformer
    expected = made(ring).points
    np.testing.assert_allclose(session.shown.binding.result, expected, atol=1e-9)
    assert np.abs(shown - expected).max() > 1e-6
    assert len(session.history.entries) == 2


def test_what_is_undone_meanwhile_stays_undone_and_what_is_done_again_is_exact(edited):
    ring, region, handle = large_ring()
    session, page = edited(Scene(ring))
    held = Event()
    session.jobs._pool.submit(held.wait, 60)
    layer, _ = let_go(session, page, handle, region)
    page.ask(session, "history.undo")
    held.set()
    settled(session, page)
    assert session.shown.binding.result.tolist() == ring.points.tolist()
    page.ask(session, "history.redo")
    expected = session.scene.stack[layer].deformer(ring).points
    np.testing.assert_allclose(session.shown.binding.result, expected, atol=1e-9)


def test_the_next_drag_goes_on_from_what_is_shown(edited):
    ring, region, handle = large_ring()
    session, page = edited(Scene(ring))
    held = Event()
    session.jobs._pool.submit(held.wait, 60)
    layer, shown = let_go(session, page, handle, region)
    page.ask(session, "surface.begin", {"layer": layer, "method": "arap"})
    held.set()
    settled(session, page)
    page.ask(session, "surface.move", matrix=sent(np.eye(4)))
    assert np.abs(session.dragging._drag.points - shown).max() < 0.5
    page.ask(session, "surface.cancel")
    expected = session.scene.stack[layer].deformer(ring).points
    np.testing.assert_allclose(session.shown.binding.result, expected, atol=1e-9)


def large_drag(session, page):
    """A handle of a large shape in hand; jobs are held back until somebody sets the event."""
    ring, region, handle = large_ring(around=120)
    session.begin(Scene(ring), "ring")
    held = Event()
    session.jobs._pool.submit(held.wait, 60)
    structure = {"region": region.astype(np.uint32), "handle": handle.astype(np.uint32)}
    page.ask(session, "surface.begin", {"method": "laplacian"}, **structure)
    return ring, region, handle, held


def test_a_long_switch_is_made_beside_the_session_while_the_drag_goes_on(edited):
    session, page = edited(Scene(BAR))
    ring, region, handle, held = large_drag(session, page)
    matrix = turn(0.4, shift=(0.0, 0.0, 0.3))
    told = page.ask(session, "surface.move", {"method": "skeleton"}, matrix=sent(matrix)).head
    assert told["method"] == "laplacian"
    assert told["job"] == page.events("progress")[-1].head["job"]
    goal = moved(ring.points[handle], matrix)
    expected = pl.LaplacianEdit(region, handle, goal=goal)(ring).points
    np.testing.assert_allclose(session.dragging._drag.points, expected, atol=1e-9)
    held.set()
    settled(session, page)
    told = page.ask(session, "surface.move", {"method": "skeleton"}).head
    assert told["method"] == "skeleton"
    assert "job" not in told
    expected = pl.SkeletonEdit(region, handle, goal=goal)(ring).points
    np.testing.assert_allclose(session.dragging._drag.points, expected, atol=1e-9)
    page.ask(session, "surface.commit")
    assert isinstance(session.scene.stack["Edit"].deformer, pl.SkeletonEdit)


def test_a_long_switch_can_be_given_up_and_asked_for_again(edited):
    session, page = edited(Scene(BAR))
    *_, held = large_drag(session, page)
    job = page.ask(session, "surface.move", {"method": "arap"}).head["job"]
    page.ask(session, "job.cancel", {"job": job})
    told = page.ask(session, "surface.move", {"method": "arap"}).head
    assert (told["method"], told["given_up"]) == ("laplacian", "arap")
    told = page.ask(session, "surface.move", {"method": "laplacian"}).head
    assert told["method"] == "laplacian"
    assert "given_up" not in told
    again = page.ask(session, "surface.move", {"method": "arap"}).head
    assert again["job"] != job
    held.set()
    page.ask(session, "surface.cancel")


def test_a_layer_changes_its_method_when_that_is_bound(edited):
    session, page = edited(Scene(BAR))
    ring, region, handle, held = large_drag(session, page)
    page.ask(session, "surface.move", matrix=sent(turn(0.4)))
    page.ask(session, "surface.commit")
    goal = session.scene.stack["Edit"].deformer.goal
    job = page.ask(session, "surface.method", {"layer": "Edit", "method": "skeleton"}).head["job"]
    assert isinstance(session.scene.stack["Edit"].deformer, pl.LaplacianEdit)
    assert job
    held.set()
    settled(session, page)
    assert [entry.key for entry in session.history.entries][1:] == ["edit", "method"]
    expected = pl.SkeletonEdit(region, handle, goal=goal)(ring).points
    np.testing.assert_allclose(session.shown.binding.result, expected, atol=1e-9)
    later = page.ask(session, "surface.method", {"layer": "Edit", "method": "laplacian"})
    assert "job" not in later.head  # known: at once


def test_a_handle_that_is_turned_about_the_limb_twists_it(edited):
    session, page = edited(Scene(BAR))
    begun(session, page, "skeleton")
    matrix = turn(np.pi / 2, axis=0)  # the bar lies along x
    page.ask(session, "surface.move", matrix=sent(matrix))
    np.testing.assert_allclose(session.dragging._drag.points[HANDLE], moved(BAR.points[HANDLE], matrix), atol=1e-9)
