"""Deformation transfer by hand: markers are clicked on two shapes, and poses play as the library puts the target."""

import json

import numpy as np

import pliant as pl
from pliant.io import meshes
from pliant.scene.scene import Scene
from pliant.studio.examples.transfer_sample import arm, posed_bar

PROBE = "window.pliantStudio.probes.transfer"
ARM = arm()
BENCH = posed_bar(ARM)
CLICKED = [8, 12]  # markers that face the eye, in the end at the right


def given(page, button, files):
    """Choose files in the dialog that a button opens."""
    with page.page.expect_file_chooser() as chooser:
        page.page.get_by_role("button", name=button, exact=True).click()
    chooser.value.set_files(files)


def clicked(page, which, vertex):
    at = page.ask(f"{PROBE}.{which}Vertex({vertex})")
    page.page.mouse.click(at["x"], at["y"])
    return at


def test_markers_are_clicked_in_pairs_and_poses_play_on_the_target(launched, view, tmp_path):
    for name, points in {"bar-rest": BENCH.source.points, "bent": BENCH.poses["bent"]}.items():
        meshes.write(BENCH.source.with_points(points), tmp_path / f"{name}.obj")
    first = [pair for i, pair in enumerate(BENCH.markers) if i not in CLICKED]
    (tmp_path / "markers.json").write_text(json.dumps({"markers": first}))
    page = view(launched(Scene(ARM)))
    page.drawn()
    page.ask("window.pliantStudio.mode('transfer')")
    given(page, "Load the source …", [tmp_path / "bar-rest.obj", tmp_path / "bent.obj"])
    page.until(f"{PROBE}.state().poses.length === 1")
    given(page, "Load …", [tmp_path / "markers.json"])
    page.until(f"{PROBE}.state().markers.length === {len(first)}")
    page.ask("window.pliantStudio.look(0.4, 1, 0.2)")
    page.ask(f"{PROBE}.lookAtSource(0.4, 1, 0.2)")
    page.settled()
    for at, i in enumerate(CLICKED):
        one, two = BENCH.markers[i]
        order = (("source", one), ("target", two)) if at else (("target", two), ("source", one))
        for which, vertex in order:
            place = clicked(page, which, vertex)
        page.until(f"{PROBE}.state().markers.length === {len(first) + at + 1}")
    pairs = page.ask(f"{PROBE}.state().markers")
    assert pairs[len(first) :] == [list(BENCH.markers[i]) for i in CLICKED]
    page.settled()
    last = page.ask(f"{PROBE}.sourceVertex({pairs[-1][0]})")
    pixel = np.array(page.ask(f"{PROBE}.sourcePixels({last['x']}, {last['y']})")[:3], int)
    assert pixel.max() - pixel.min() > 60  # a coloured marker on grey
    assert abs(place["x"] - page.ask(f"{PROBE}.targetVertex({pairs[-1][1]})")["x"]) < 2
    page.picture("transfer-markers")

    revision = page.session.revision
    page.page.get_by_role("button", name="Transfer the poses").click()
    page.until(f"{PROBE}.state().ready", 60)
    page.committed(revision)
    clone = pl.DeformationTransfer(BENCH.source, ARM, np.array(pairs))
    posed = clone.points(np.array(meshes.read(tmp_path / "bent.obj").points))
    np.testing.assert_allclose(page.positions(len(posed)), posed, atol=1e-5)
    page.until(f"Math.abs({PROBE}.sourcePosition(0)[2] - {BENCH.poses['bent'][0, 2]}) < 1e-5")  # the source too
    source = np.array([page.ask(f"{PROBE}.sourcePosition({vertex})") for vertex in range(0, 1300, 100)])
    np.testing.assert_allclose(source, BENCH.poses["bent"][:1300:100], atol=1e-5)
    page.picture("transfer-posed")

    revision = page.session.revision
    page.page.locator("canvas").first.focus()
    page.page.keyboard.press("Space")
    page.until(f"{PROBE}.playing() && {PROBE}.weights()[0] > 0.2 && {PROBE}.weights()[0] < 0.9")
    page.page.keyboard.press("Space")
    page.committed(revision)
    (layer,) = page.session.scene.stack
    weight = float(layer.deformer.controls[0])
    expected = ARM.points + weight * (posed - ARM.points)
    np.testing.assert_allclose(page.positions(len(posed)), expected, atol=1e-5)

    page.page.get_by_role("button", name="Delete 1", exact=True).click()
    page.until(f"{PROBE}.state().markers.length === {len(pairs) - 1}")
    assert page.ask(f"{PROBE}.state().ready") is False
    with page.page.expect_download() as download:
        page.page.get_by_role("button", name="Save", exact=True).last.click()
    assert json.loads(download.value.path().read_text())["markers"] == pairs[1:]
