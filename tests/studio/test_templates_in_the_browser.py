"""The gallery of templates and the export of clips in a real browser; guides of modes that are new to somebody."""

import numpy as np
import pytest
from test_time_in_the_browser import moving_scene, opened

import pliant as pl
from pliant.scene.scene import Scene
from pliant.studio.examples.samples import vase

WIDE, HIGH = 60, 42
PIXELS = f"""(name) => {{
  const small = new OffscreenCanvas({WIDE}, {HIGH}).getContext('2d');
  small.drawImage(document.querySelector(`[data-template="${{name}}"] canvas`), 0, 0, {WIDE}, {HIGH});
  return [...small.getImageData(0, 0, {WIDE}, {HIGH}).data];
}}"""


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("PLIANT_TEMPLATES", str(tmp_path / "templates"))


def drawn(page, name):
    """(h, w, 4) the picture of a template, smaller."""
    return np.array(page.page.evaluate(PIXELS, name)).reshape(HIGH, WIDE, 4)


def test_templates_are_seen_on_the_scene_s_mesh_and_applied(launched, view):
    page = view(launched(Scene(vase(around=24, along=36))))
    page.drawn()
    page.page.keyboard.press("t")
    page.page.get_by_role("button", name="Templates").click()
    page.until("document.querySelectorAll('.template-card').length === 34")
    page.until("document.querySelectorAll('.template-card.drawn').length >= 8", patience=60)
    first = drawn(page, "banana")
    covered = (first[..., 3] > 0).mean()
    assert 0.02 < covered < 0.6  # a shape, with room around it
    shades = first[first[..., 3] == 255][:, :3].astype(int)
    assert np.ptp(shades.sum(axis=1)) > 90  # which light models
    assert any(np.abs(drawn(page, "banana").astype(int) - first).max() > 40 for _ in range(60))  # which moves
    page.picture("templates")
    page.page.get_by_label("Search templates").fill("hourglass")
    page.until("document.querySelectorAll('.template-card:not([hidden])').length === 1")
    page.page.locator("[data-template='hourglass']").click()
    page.page.locator(".template-side input[type=range]").fill("0.5")
    page.page.get_by_label("Duration").last.fill("3")
    page.page.keyboard.press("Tab")
    revision = page.session.revision
    page.page.get_by_role("button", name="Apply").click()
    page.committed(revision)
    mesh = page.session.scene.mesh
    expected = pl.template("hourglass").clip(mesh, intensity=0.5, duration=3.0)
    clip = page.session.scene.clip
    assert clip.duration == 3.0
    for time in (0.5, 2.0):
        np.testing.assert_allclose(clip.sample(time).points, expected.sample(time).points, atol=1e-12)
    assert page.page.locator(".track-row.layer-row").count() == len(clip.stack)


def test_a_clip_is_downloaded_and_what_is_lost_is_shown(launched, view, tmp_path):
    page = opened(launched, view)
    page.page.locator(".transport").get_by_role("button", name="Export").click()
    page.page.get_by_label("Format").select_option(".pc2")
    with page.page.expect_download() as waiting:
        page.page.get_by_role("button", name="Download").click()
    path = tmp_path / waiting.value.suggested_filename
    waiting.value.save_as(path)
    clip = moving_scene().clip
    motion = pl.read_sequence(path, mesh=clip.mesh)
    expected = np.stack([frame.points for frame in clip.frames()])
    np.testing.assert_allclose(np.asarray(motion.points), expected, atol=1e-6)
    page.until("document.querySelector('.report .loss') !== null")
    assert "positions" in page.page.locator(".report .loss").first.inner_text()
    page.picture("motion-export")


@pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning"
)  # the encoder's library leaves pipes open
def test_a_film_and_a_moving_glb_are_downloaded_and_show_the_clip(launched, view, tmp_path):
    import imageio.v3 as imageio

    page = opened(launched, view, fps=1.0)
    page.page.locator(".transport").get_by_role("button", name="Export").click()
    page.page.get_by_label("Format").select_option(".glb")
    clip = moving_scene(fps=1.0).clip
    motion = pl.read_sequence(downloaded(page, tmp_path), mesh=clip.mesh, fps=1)
    expected = np.stack([frame.points for frame in clip.frames()])
    np.testing.assert_allclose(np.asarray(motion.points), expected, atol=1e-5)
    page.page.get_by_label("Format").select_option(".mp4")
    page.page.get_by_label("Size").select_option("640 × 360")
    frames = np.asarray(imageio.imread(downloaded(page, tmp_path), index=...))
    assert frames.shape == (len(expected), 360, 640, 3)
    grey = frames.astype(float).mean(axis=-1)
    assert np.ptp(grey[0]) > 60  # a shape on a ground
    assert np.abs(grey[0] - grey[-1]).max() > 40  # that moves


def downloaded(page, folder):
    """The file that comes of a click, kept."""
    with page.page.expect_download(timeout=120_000) as waiting:
        page.page.get_by_role("button", name="Download").click()
    path = folder / waiting.value.suggested_filename
    waiting.value.save_as(path)
    page.until("document.querySelector('.report h3') !== null")
    return path


def test_a_guide_comes_once_can_be_skipped_and_starts_anew_from_the_help_sheet(launched, view):
    page = view(launched(moving_scene()), locale="en-GB")  # somebody who is new here
    page.page.goto(f"{page.studio.url}&antialias=off")
    page.until("window.pliantStudio !== undefined && document.querySelector('.link.open') !== null")
    card = page.page.locator(".tour")
    page.until("document.querySelector('.tour') !== null")
    assert "Drag a control point" in card.inner_text()
    page.page.keyboard.press("Enter")  # the button that goes on has the focus
    page.until("document.querySelector('.tour h3').textContent === 'Choose how they move'")
    ring, bar = page.page.locator(".tour-ring").bounding_box(), page.page.locator(".stage-top .toolbar").bounding_box()
    assert ring["x"] < bar["x"] < bar["x"] + bar["width"] < ring["x"] + ring["width"]
    page.picture("guide")
    page.page.keyboard.press("Escape")
    assert card.count() == 0
    page.page.keyboard.press("t")
    page.until("document.querySelector('.tour h3')?.textContent === 'Through time'")
    page.page.get_by_role("button", name="Skip this guide").click()
    page.page.keyboard.press("2")
    page.page.keyboard.press("t")
    page.settled()
    assert card.count() == 0  # each comes once
    page.page.keyboard.press("?")
    page.page.get_by_role("group", name="Guides").get_by_role("button", name="Look").click()
    page.until("document.querySelector('.tour h3')?.textContent === 'Turn it'")
    page.page.keyboard.press("Escape")
    page.until("document.querySelector('.tour') === null")
    page.page.reload()
    page.until("window.pliantStudio !== undefined && document.querySelector('.link.open') !== null")
    page.drawn()
    assert card.count() == 0
