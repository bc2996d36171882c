"""Faces by hand in a real browser: a photograph is dropped, its caricature is what the library makes."""

import base64
from pathlib import Path

import numpy as np
import pytest
import skimage

import pliant as pl
from pliant.studio.commands.opening import read_scene

PORTRAIT = Path(skimage.__file__).parent / "data" / "astronaut.png"
COFFEE = Path(skimage.__file__).parent / "data" / "coffee.png"
DROP = """async ([name, data]) => {
  const bytes = Uint8Array.from(atob(data), (each) => each.charCodeAt(0));
  const files = new DataTransfer();
  files.items.add(new File([bytes], name));
  document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: files, bubbles: true, cancelable: true }));
}"""


def drop(page, path):
    """As if somebody had dragged a file onto the page."""
    page.page.evaluate(DROP, [path.name, base64.b64encode(path.read_bytes()).decode()])


def ready(page):
    page.until("window.pliantStudio.probes.face.ready()", 60)
    page.settled()


@pytest.fixture(scope="module")
def dense():
    return pl.dense_face(pl.face_from_photo(PORTRAIT)).filled()


def same_points(page, expected):
    np.testing.assert_allclose(page.positions(len(expected)), expected, atol=1e-5)


def test_a_dropped_photograph_becomes_a_face_and_sliders_its_caricature(launched, view, dense, tmp_path):
    page = view(launched())
    page.until("!document.querySelector('.start').hidden")
    drop(page, PORTRAIT)
    page.until("document.querySelector('.start').hidden", 60)
    page.drawn()
    ready(page)
    same_points(page, dense.mesh.points)
    assert page.ask("window.pliantStudio.probes.face.dots()")
    page.picture("face-landmarks")
    page.page.get_by_label("Landmarks").uncheck()
    page.until("!window.pliantStudio.probes.face.dots()")
    the_photograph_is_seen(page, dense)
    revision = page.session.revision
    track = page.page.get_by_label("Caricature –").bounding_box()
    middle = track["x"] + track["width"] / 3  # of −1 to 2
    page.drag((middle, track["y"] + 10), (track["width"] / 4, 0))
    page.committed(revision)
    ready(page)
    page.page.get_by_label("Nose", exact=True).fill("1.6")
    page.page.keyboard.press("Enter")
    page.committed(revision + 1)
    ready(page)
    amount = page.session.scene.stack["Caricature"].deformer.amount
    assert 0.6 < amount < 0.9
    made = pl.caricature(dense, amount, {"nose": 1.6})
    same_points(page, made.face.mesh.points)
    assert page.ask("window.pliantStudio.probes.face.facts().least") == pytest.approx(made.least, abs=1e-6)
    page.picture("face-caricature")
    it_comes_back_from_a_project_with_its_picture(page, tmp_path, made)


def the_photograph_is_seen(page, dense):
    """At the cheek there is skin, at the open eye there is white: what the picture has there."""
    page.until("!window.pliantStudio.waiting")
    page.ask("window.pliantStudio.look(0, 0, 1)")
    page.settled()
    pixels = dense.picture.pixels
    for landmark in (205, 425):  # cheeks
        vertex = int(np.argmin(np.linalg.norm(dense.mesh.points - dense.landmarks[landmark], axis=1)))
        at = page.ask(f"window.pliantStudio.vertex({vertex})")
        seen = page.pixels(at["x"] - 2, at["y"] - 2, 5, 5).reshape(-1, 3).mean(axis=0)
        u, v = dense.mesh.uvs.values[vertex]
        expected = pixels[round((1 - v) * (len(pixels) - 1)), round(u * (pixels.shape[1] - 1))]
        ratio = seen / np.maximum(expected, 1)
        assert np.ptp(ratio) < 0.25  # the same hue; light makes it brighter or darker
        assert 0.5 < ratio.mean() < 1.6


def it_comes_back_from_a_project_with_its_picture(page, tmp_path, made):
    with page.page.expect_download() as saving:
        page.page.keyboard.press("Control+s")
    saving.value.save_as(tmp_path / "face.pliant")
    again = read_scene(tmp_path / "face.pliant")
    np.testing.assert_allclose(again.deformed().points, made.face.mesh.points, atol=1e-9)
    assert again.mesh.material_library["skin"].texture.read_bytes() == made.face.picture.png()


def test_a_photograph_of_no_face_is_told(launched, view):
    page = view(launched())
    page.until("!document.querySelector('.start').hidden")
    drop(page, COFFEE)
    page.until("document.querySelector('.toast') !== null", 60)
    assert "no face is found" in page.page.locator(".toast").first.inner_text()
    assert page.session.scene is None
