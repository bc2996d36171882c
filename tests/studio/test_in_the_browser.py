"""The studio in a real browser, against what the library computes."""

import shutil
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bodies_to_edit import moved_scene, round_scene

import pliant as pl
from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.space.smooth_dragging import SmoothDrag


def same_points(view, tolerance=2e-6):
    """The page draws what the session's scene gives."""
    expected = view.session.scene.deformed().points
    np.testing.assert_allclose(
        view.positions(len(expected)), expected, atol=tolerance * view.session.scene.mesh.diagonal
    )


def test_a_dragged_control_point_moves_the_mesh_as_the_library_does(launched, view):
    page = view(launched(round_scene()))
    page.drawn()
    page.handles()
    revision = page.session.revision
    page.drag(page.control(63), (70, -50), release=False)
    page.until("window.pliantStudio.latencies.length > 0")
    page.settled()  # the last move, too, has been answered and drawn
    during = page.positions(len(page.session.scene.mesh.points))
    assert page.session.revision == revision  # previews are no history
    page.page.mouse.up()
    page.committed(revision)
    assert page.session.revision == revision + 1  # one entry
    moved = page.session.scene.stack["Lattice"].deformer
    assert np.flatnonzero(np.linalg.norm(moved.displacements, axis=-1).reshape(-1)).tolist() == [63]
    same_points(page)
    np.testing.assert_allclose(during, page.positions(len(during)), atol=1e-4 * page.session.scene.mesh.diagonal)
    page.picture("dragged")


def test_a_finger_drags_a_control_point_and_turns_the_view(launched, view):
    page = view(launched(round_scene()), has_touch=True)
    page.drawn()
    page.handles()
    screen = page.page.context.new_cdp_session(page.page)

    def swipe(start, by):
        for part in (0.0, 0.25, 0.5, 0.75, 1.0):
            point = {"x": start[0] + part * by[0], "y": start[1] + part * by[1]}
            kind = "touchStart" if part == 0 else "touchMove"
            screen.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [point]})
        screen.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})

    revision = page.session.revision
    x, y = page.control(63)
    swipe((x + 9, y - 6), (60, -40))  # a finger need not be exact
    page.committed(revision)
    moved = page.session.scene.stack["Lattice"].deformer
    assert np.flatnonzero(np.linalg.norm(moved.displacements, axis=-1).reshape(-1)).tolist() == [63]
    same_points(page)
    before = page.control(0)
    swipe((520, 590), (90, -30))
    page.settled()
    assert np.hypot(*np.subtract(page.control(0), before)) > 10
    assert page.session.revision == revision + 1


def test_a_typed_displacement_is_exact_and_can_be_undone(launched, view):
    page = view(launched(round_scene()))
    page.drawn()
    page.handles()
    revision = page.session.revision
    page.page.mouse.click(*page.control(63))
    page.page.get_by_label("Displacement z").fill("0.375")
    page.page.keyboard.press("Enter")
    page.committed(revision)
    assert page.session.scene.stack["Lattice"].deformer.displacements[3, 3, 3].tolist() == [0.0, 0.0, 0.375]
    same_points(page)
    page.page.keyboard.press("Escape")
    page.page.locator("canvas").first.focus()
    page.page.keyboard.press("Control+z")
    page.committed(revision + 1)
    assert not page.session.scene.stack["Lattice"].deformer.displacements.any()
    same_points(page)
    page.page.keyboard.press("Control+y")
    page.committed(revision + 2)
    assert page.session.scene.stack["Lattice"].deformer.displacements.any()


def test_whole_layers_and_rectangles_are_selected(launched, view):
    page = view(launched(round_scene()))
    page.drawn()
    page.handles()
    page.page.get_by_role("button", name="k", exact=True).click()
    assert page.ask("window.pliantStudio.selection()") == [4 * i for i in range(16)]
    page.page.get_by_label("Layer i").fill("2")
    page.page.keyboard.press("Enter")
    assert page.ask("window.pliantStudio.selection()") == list(range(32, 48))
    page.page.locator("canvas").first.focus()
    page.page.keyboard.press("b")
    page.drag((70, 130), (700, 560))
    assert page.ask("window.pliantStudio.selection().length") == 64


def test_soft_selection_mirror_and_axis_lock(launched, view):
    page = view(launched(round_scene((5, 5, 3))))
    page.drawn()
    page.handles()
    page.page.locator("canvas").first.focus()
    page.page.keyboard.press("o")
    page.page.keyboard.press("x")
    page.page.get_by_label("Mirror").select_option("1")
    revision = page.session.revision
    page.drag(page.control(0), (60, -60))
    page.committed(revision)
    displacement = page.session.scene.stack["Lattice"].deformer.displacements
    assert not displacement[..., 1:].any()  # locked to x
    np.testing.assert_allclose(displacement, displacement[:, ::-1], atol=1e-12)  # mirrored in j
    near, far = abs(displacement[1, 0, 0, 0]), abs(displacement[4, 0, 0, 0])
    assert abs(displacement[0, 0, 0, 0]) > near > far == 0  # softer with distance


def test_neighbours_go_along_so_that_patches_meet_smoothly(launched, view):
    mesh = round_scene().mesh
    turn = pl.Affine.rotation("z", 0.5, (0.0, 0.0, 0.0)).matrix[:3, :3]
    lattice = pl.BezierFFD.around(mesh, patches=(2, 1, 1), margin=0.05, axes=turn)
    page = view(launched(Scene(mesh, Stack((Layer("Patches", lattice),)))))
    page.drawn()
    page.handles()
    toolbar, canvas = (page.page.locator(place).first for place in (".stage-top .toolbar", "canvas"))
    assert toolbar.bounding_box()["height"] < 60  # all its buttons in one row, those of turned axes and joints too
    canvas.focus()
    revision, point = page.session.revision, int(np.ravel_multi_index((2, 0, 3), lattice.shape))
    page.drag(page.control(point), (0, -60), release=False)
    rest = lattice.rest.reshape(-1, 3)
    across = int(np.ravel_multi_index((4, 0, 3), lattice.shape))
    moved = f"window.pliantStudio.controlPosition({across})[2] < {rest[across][2] - 0.01}"
    page.until(moved)  # the handle beyond the joint goes the other way
    page.page.mouse.up()
    page.committed(revision)
    made = page.session.scene.stack["Patches"].deformer.controls.reshape(-1, 3)
    np.testing.assert_allclose(made, SmoothDrag(lattice, np.array([point])).controls(made[[point]]), atol=1e-9)
    canvas.focus()
    page.page.keyboard.press("j")
    page.drag(page.control(point), (0, 30))
    page.committed(revision + 1)
    alone = page.session.scene.stack["Patches"].deformer.controls.reshape(-1, 3)
    assert np.flatnonzero((alone != made).any(axis=1)).tolist() == [point]
    page.page.keyboard.press("r")
    page.page.keyboard.press("o")
    page.page.keyboard.press("n")
    assert toolbar.bounding_box()["height"] < 60  # the numbers of what is on stand in a row of their own
    page.picture("points-toolbar")


def test_the_gizmo_turns_a_layer_about_its_centre(launched, view):
    page = view(launched(round_scene()))
    page.drawn()
    page.handles()
    page.page.get_by_role("button", name="k", exact=True).click()
    page.page.locator("canvas").first.focus()
    page.page.keyboard.press("r")
    page.page.keyboard.press("z")
    page.ask("window.pliantStudio.look(0, 0, 1)")
    page.settled()
    revision = page.session.revision
    centers = np.array([page.control(4 * i) for i in range(16)]).mean(axis=0)
    radius = page.ask("window.pliantStudio.gizmoRadius()")
    page.drag((centers[0], centers[1] + radius), (radius * 0.8, -radius * 0.6), steps=8)
    page.committed(revision)
    lattice = page.session.scene.stack["Lattice"].deformer
    before, after = lattice.rest[:, :, 0].reshape(-1, 3), lattice.controls[:, :, 0].reshape(-1, 3)
    np.testing.assert_allclose(after.mean(axis=0), before.mean(axis=0), atol=1e-9)
    distances = [np.linalg.norm(each - each.mean(axis=0), axis=1) for each in (before, after)]
    np.testing.assert_allclose(*distances, atol=1e-9)
    assert np.linalg.norm(after - before, axis=1).max() > 0.1


def test_a_point_of_the_surface_is_pulled(launched, view):
    page = view(launched(round_scene((6, 6, 4))))
    page.drawn()
    page.ask("window.pliantStudio.mode('pull')")
    page.ask("window.pliantStudio.look(0, -0.4, 1)")
    page.settled()
    revision = page.session.revision
    vertex = 7  # on top of the tube
    at = page.ask(f"window.pliantStudio.vertex({vertex})")
    page.drag((at["x"], at["y"]), (40, 30))
    page.committed(revision)
    after = page.ask(f"window.pliantStudio.vertex({vertex})")
    assert abs(after["x"] - at["x"] - 40) < 3
    assert abs(after["y"] - at["y"] - 30) < 3
    same_points(page)


def test_a_colour_map_shows_the_legend_s_colours(launched, view):
    page = view(launched(moved_scene()))
    page.drawn()
    page.page.get_by_label("Colour").select_option("displacement")
    page.until("!document.querySelector('.legend').hidden")
    page.settled()
    page.ask("window.pliantStudio.mode('look')")
    scene = page.session.scene
    length = np.linalg.norm(scene.deformed().points - scene.mesh.points, axis=1)
    most = int(length.argmax())
    direction = scene.deformed().points[most] / np.linalg.norm(scene.deformed().points[most])
    page.ask(f"window.pliantStudio.look({direction[0]}, {direction[1]}, {direction[2]})")
    page.settled()
    page.picture("colour-map")
    at = page.ask(f"window.pliantStudio.vertex({most})")
    from pliant.rendering.palette import SEQUENTIAL, color_table

    expected = 255 * color_table(SEQUENTIAL)[-1]
    assert np.abs(page.pixels(at["x"], at["y"])[0, 0] - expected).max() < 20


def test_muting_restores_the_shape_and_solo_silences_others(launched, view):
    page = view(launched(moved_scene()))
    page.drawn()
    revision = page.session.revision
    page.page.get_by_role("button", name="Mute", exact=True).click()
    page.committed(revision)
    np.testing.assert_allclose(page.positions(50), page.session.scene.mesh.points[:50], atol=1e-6)
    page.page.get_by_role("button", name="Unmute").click()
    page.committed(revision + 1)
    same_points(page)


def test_layers_are_added_from_the_catalogue_and_edited_by_their_fields(launched, view):
    page = view(launched(round_scene()))
    page.drawn()
    revision = page.session.revision
    page.page.get_by_role("button", name="Add a deformer").click()
    page.page.get_by_placeholder("Search deformers").fill("twist")
    page.page.keyboard.press("Enter")
    page.committed(revision)
    assert page.session.scene.stack.names == ("Lattice", "Twist")
    page.page.get_by_label("angle", exact=True).fill("90")
    page.page.keyboard.press("Enter")
    page.committed(revision + 1)
    assert page.session.scene.stack["Twist"].deformer.angle == pytest.approx(np.pi / 2)
    same_points(page)
    page.page.locator("[data-layer=Twist]").focus()
    page.page.keyboard.press("Alt+ArrowDown")
    page.committed(revision + 2)
    assert page.session.scene.stack.names == ("Twist", "Lattice")


def test_a_textured_obj_is_dropped_and_shown_with_its_texture(launched, view, tmp_path):
    folder = tmp_path / "obj"
    folder.mkdir()
    mesh = round_scene().mesh
    copy = shutil.copy(mesh.material_library["checkers"].texture, folder)
    library = {"checkers": replace(mesh.material_library["checkers"], texture=Path(copy))}
    pl.write(mesh.replace(material_library=library), folder / "ring.obj")
    page = view(launched())
    files = sorted(str(each) for each in folder.iterdir())
    assert len(files) == 3  # the mesh, its materials, its texture
    with page.page.expect_file_chooser() as chooser:
        page.page.get_by_role("button", name="Drop a mesh").click()
    chooser.value.set_files(files)
    page.drawn()
    page.page.wait_for_timeout(300)
    page.ask("window.pliantStudio.mode('look')")
    page.settled()
    pixels = page.pixels(60, 60, 600, 500).reshape(-1, 3)
    blue = (pixels[:, 2] - pixels[:, 0] > 50).mean()
    assert blue > 0.02  # half of the checkerboard
    assert page.session.scene.mesh.uvs is not None


def test_an_ffd_file_is_imported_and_exported(launched, view, tmp_path):
    scene = round_scene((5, 4, 4))
    lattice = scene.stack["Lattice"].deformer
    controls = np.array(lattice.rest)
    controls[2, 2, 2] += [0.1, 0.2, 0.3]
    file = tmp_path / "warp.FFD"
    pl.write_transform(lattice.moved(controls), file)
    page = view(launched(scene.replace(stack=pl.Stack())))
    page.drawn()
    revision = page.session.revision
    page.page.get_by_role("button", name="Open", exact=True).click()
    with page.page.expect_file_chooser() as chooser:
        page.page.get_by_role("menuitem", name="Open a file").click()
    chooser.value.set_files(str(file))
    page.until("document.querySelector('.preview-summary') !== null")
    assert "5 × 4 × 4" in page.page.locator(".preview-summary").inner_text()
    page.picture("import")
    page.page.get_by_role("button", name="Import", exact=True).click()
    page.committed(revision)
    expected = pl.read_transform(file)(scene.mesh).points
    np.testing.assert_allclose(page.positions(len(expected)), expected, atol=1e-5)
    page.page.get_by_role("button", name="Export", exact=True).click()
    page.page.get_by_role("radio", name="Deformation").click()
    with page.page.expect_download() as download:
        page.page.get_by_role("button", name="Download").click()
    page.until("document.querySelector('.report h3') !== null")
    download.value.save_as(tmp_path / "again.FFD")
    again = pl.read_transform(tmp_path / "again.FFD")
    np.testing.assert_allclose(again(scene.mesh).points, expected, atol=1e-5)


def test_field_lines_arrows_and_a_fold_are_shown(launched, view):
    scene = moved_scene()
    lattice = scene.stack["Lattice"].deformer
    controls = np.array(lattice.rest)
    controls[1, 1, 1] += [5, 0, 0]
    page = view(launched(scene.replace(stack=scene.stack.replace("Lattice", deformer=lattice.moved(controls)))))
    page.drawn()
    page.page.get_by_label("Grid lines").check()
    page.page.get_by_label("Arrows").check()
    page.until("document.querySelector('.fold.folds') !== null")
    page.settled()
    page.picture("field")
    revision = page.session.revision
    page.page.get_by_role("button", name="Reduce until fold-free").click()
    page.committed(revision)
    page.until("document.querySelector('.fold.fold-free') !== null")
    assert pl.certify(page.session.scene.stack["Lattice"].deformer).status == "fold-free"


def test_two_tabs_see_one_session(launched, view):
    studio = launched(round_scene())
    one, two = view(studio), view(studio)
    one.drawn()
    two.drawn()
    one.handles()
    revision = one.session.revision
    one.drag(one.control(63), (50, -40), release=False)
    two.until("Math.abs(window.pliantStudio.frames) > 2")
    one.page.mouse.up()
    one.committed(revision)
    two.settled()
    np.testing.assert_array_equal(one.positions(200), two.positions(200))
    two.page.get_by_role("button", name="Undo (Ctrl-Z)").click()
    one.committed(revision + 1)
    two.settled()
    assert not one.session.scene.stack["Lattice"].deformer.displacements.any()
    np.testing.assert_array_equal(one.positions(200), two.positions(200))


def test_a_reload_shows_the_same(launched, view):
    page = view(launched(moved_scene()))
    page.drawn()
    before = page.positions(100)
    page.page.reload()
    page.until("window.pliantStudio !== undefined && document.querySelector('.link.open') !== null")
    page.drawn()
    np.testing.assert_array_equal(page.positions(100), before)


def test_unsaved_work_is_recovered_after_a_crash(launched, view):
    first = launched(round_scene(), own=True)
    page = view(first)
    page.drawn()
    page.handles()
    revision = page.session.revision
    page.drag(page.control(63), (50, -40))
    page.committed(revision)
    expected = page.session.scene.deformed().points
    page.session.autosave.flush()  # a killed studio leaves what it has kept; nothing else of it is used below
    page.page.close()
    again = view(launched(own=True))
    again.until("document.querySelector('.recovery button') !== null")
    again.page.locator(".recovery button").first.click()
    again.drawn()
    np.testing.assert_allclose(again.positions(len(expected)), expected, atol=1e-5)


def test_before_and_after_beside_each_other(launched, view):
    page = view(launched(moved_scene()))
    page.drawn()
    page.ask("window.pliantStudio.mode('look')")
    page.settled()
    whole = page.pixels(60, 100, 620, 400)
    page.page.get_by_role("button", name="Before / after").click()
    page.until("!document.querySelector('.divider').hidden")
    page.settled()
    halves = page.pixels(60, 100, 620, 400)
    assert (whole[:, :300] != halves[:, :300]).any()
    np.testing.assert_array_equal(whole[:, 320:], halves[:, 320:])


def test_what_cannot_be_read_is_told_and_nothing_is_lost(launched, view, tmp_path):
    page = view(launched(round_scene()))
    page.drawn()
    bad = tmp_path / "bad.off"
    bad.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 x\n3 0 1 2\n")
    page.page.get_by_role("button", name="Open", exact=True).click()
    with page.page.expect_file_chooser() as chooser:
        page.page.get_by_role("menuitem", name="Open a file").click()
    chooser.value.set_files(str(bad))
    page.page.locator(".toast.error").wait_for()
    assert "bad.off, line 5" in page.page.locator(".toast.error").inner_text()
    same_points(page)


def test_chinese_and_dark(launched, view):
    page = view(launched(moved_scene()), color_scheme="dark")
    page.drawn()
    assert page.ask("document.body.dataset.theme") == "dark"
    page.picture("dark")
    page.page.get_by_role("button", name="语言 / Language").click()
    page.page.get_by_role("menuitemcheckbox", name="中文").click()
    assert page.page.get_by_role("button", name="导出").count() == 1
    assert page.ask("document.body.lang") == "zh-CN"


def test_the_help_sheet_and_the_view_by_keys(launched, view):
    page = view(launched(moved_scene()), color_scheme="light")
    page.drawn()
    page.page.locator("canvas").first.focus()
    page.page.keyboard.press("w")
    page.page.keyboard.press("p")
    page.settled()
    page.page.keyboard.press("?")
    sheet = page.page.get_by_role("dialog", name="Keyboard and mouse")
    sheet.wait_for()
    own = sheet.locator("details[open]")  # the keys of the mode that is on
    assert own.count() == 1
    assert "Soft selection" in own.inner_text()
    sheet.locator("summary", has_text="Edit the surface").click()
    assert "The next method, also while you drag" in sheet.locator("details[open]").last.inner_text()
    page.picture("help-sheet")
    page.page.keyboard.press("Escape")


def test_a_lost_connection_is_told_and_the_shape_stays(launched, view):
    studio = launched(moved_scene(), own=True)
    page = view(studio, color_scheme="light")
    page.drawn()
    before = page.positions(50)
    studio.stop()
    page.until("document.querySelector('.link.lost') !== null")
    np.testing.assert_array_equal(page.positions(50), before)
    assert "Trying again" in page.page.locator(".link").inner_text()
    page.page.close()
    page.complaints.clear()  # the browser complains, time and again, that nobody listens


def test_a_connection_that_comes_back_shows_what_has_happened_meanwhile(launched, view):
    page = view(launched(round_scene()))
    page.drawn()
    session = page.session
    before = list(session.clients)
    for client in before:
        client._loop.call_soon_threadsafe(lambda each=client: each._loop.create_task(each._socket.close()))
    end = time.monotonic() + 15
    while set(session.clients) & set(before):
        assert time.monotonic() < end
        time.sleep(0.01)
    session.submit(session.begin, moved_scene(), "another").result()
    page.until("document.querySelector('.link.open') !== null")
    page.settled()
    same_points(page)


def test_a_drag_is_locked_to_an_axis_of_a_lattice_that_is_turned(launched, view):
    mesh = round_scene().mesh
    axes = np.linalg.qr(np.array([[2.0, 0.3, 0.1], [0.5, 2.0, -0.2], [0.6, 0.4, 2.0]]))[0]
    axes[:, 2] *= np.linalg.det(axes)
    lattice = pl.BSplineFFD.around(mesh, shape=(3, 3, 3), axes=axes)
    page = view(launched(pl.Scene(mesh, pl.Stack([pl.Layer("Lattice", lattice)]))))
    page.drawn()
    page.handles()
    page.page.locator("canvas").first.focus()
    for key in ("l", "x"):
        page.page.keyboard.press(key)
    revision = page.session.revision
    page.drag(page.control(26), (60, -40))
    page.committed(revision)
    move = page.session.scene.stack["Lattice"].deformer.displacements[2, 2, 2]
    assert np.linalg.norm(move) > 0.05
    np.testing.assert_allclose(np.abs(move @ axes) / np.linalg.norm(move), [1, 0, 0], atol=1e-9)
    same_points(page)
    page.picture("local-axes")
