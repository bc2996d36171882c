"""Draws the studio's pictures in the documentation: python tools/studio_pictures.py [NAME ...] (needs chromium)."""

from __future__ import annotations

import io
import shutil
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from PIL import Image

import pliant as pl
from pliant.studio.examples.sample_scenes import (
    astronaut,
    bent_bar,
    caged_vase,
    raised_arm,
    sited_egg,
    swallowing_column,
    varying_head,
)
from pliant.studio.examples.samples import textured_vase, torus
from pliant.studio.serving.launching import launch

OUT = Path(__file__).parents[1] / "docs" / "pictures"
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def main(names: list[str]) -> None:
    """Draw those that are named, or all."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        for name, draw in PICTURES.items():
            if not names or name in names:
                draw(browser)
        browser.close()


@contextmanager
def shown(browser, scene: pl.Scene, name: str, mode: str, size=(1280, 800), scale=1.5):
    """A page on a scene, in a mode."""
    with tempfile.TemporaryDirectory() as folder:
        studio = launch(scene, name, port=0, autosave=Path(folder))
        studio.start()
        page = browser.new_page(viewport={"width": size[0], "height": size[1]}, device_scale_factor=scale)
        page.goto(f"{studio.url}&guides=off")
        wait(page, "window.pliantStudio && document.querySelector('.start').hidden")
        page.evaluate(f"window.pliantStudio.mode('{mode}')")
        yield page
        page.close()
        studio.stop()


def lattices(browser) -> None:
    """Control points of a lattice, its field, and a clip of a drag."""
    mesh = torus(120, 52)
    lattice = pl.BSplineFFD.around(mesh, shape=(5, 5, 3), margin=0.08)
    controls = np.array(lattice.rest)
    controls[4, 3, 2] += [0.45, 0.3, 0.55]
    controls[0, 1, 2] += [-0.1, 0.0, 0.35]
    scene = pl.Scene(mesh, pl.Stack([pl.Layer("Lattice", lattice.moved(controls))]))
    with shown(browser, scene, "torus", "points") as page:
        wait(page, "window.pliantStudio.controlPoint(0) !== null")
        at = page.evaluate("window.pliantStudio.controlPoint(71)")
        page.mouse.click(at["x"], at["y"])
        save(page, "studio")
        page.get_by_label("Colour").select_option("displacement")
        page.get_by_label("Grid lines").check()
        page.evaluate("window.pliantStudio.mode('look')")
        time.sleep(2)
        page.get_by_label("Colour").scroll_into_view_if_needed()
        save(page, "studio-field")
    with shown(browser, scene, "torus", "points", (900, 600), 1.0) as page:
        wait(page, "window.pliantStudio.controlPoint(0) !== null")
        clip(page)


def models(browser) -> None:
    """A model of a head with three landmarks, two of them moved: the posterior and its uncertainty."""
    scene = varying_head()
    shape = scene.stack["Shape model"].deformer
    points = shape.model.mean
    for direction in ((0.2, -1, 0.25), (-0.7, -0.7, 0.1), (0.1, -0.4, 1)):
        shape = shape.with_landmark(int(np.argmax(points @ direction)))
    moved = np.array([[0.25, -0.35, 0.1], [0, 0, 0], [-0.1, 0, 0.2]]) + shape.positions
    shape = shape.moved(np.concatenate([np.zeros(shape.model.count), moved.reshape(-1)]))
    with shown(browser, scene.replace(stack=pl.Stack([pl.Layer("Shape model", shape)])), "head", "model") as page:
        wait(page, "window.pliantStudio.probes.model.painted()")
        page.evaluate("window.pliantStudio.look(0.35, -1, 0.25)")
        time.sleep(1)
        save(page, "studio-model", (1000, 625))


def faces(browser) -> None:
    """The astronaut's face, and its caricature."""
    scene = astronaut()
    made = scene.stack["Caricature"].deformer.moved([0.8, 1, 1.2, 1.6, 1.1, 1, 1, 1])
    with shown(browser, scene.replace(stack=pl.Stack([pl.Layer("Caricature", made)])), "astronaut", "face") as page:
        wait(page, "window.pliantStudio.probes.face.ready()")
        page.get_by_label("Landmarks").uncheck()
        page.get_by_label("Caricature –").scroll_into_view_if_needed()
        time.sleep(2)
        save(page, "studio-face", (1000, 625))


def bends(browser) -> None:
    """A bar, twisted and bent, with the handles of the bend."""
    with shown(browser, bent_bar(), "bar", "axial") as page:
        wait(page, "window.pliantStudio.probes.axial.names().length > 0")
        page.evaluate("window.pliantStudio.look(0.55, -1, 0.55)")
        time.sleep(1)
        at = page.evaluate("window.pliantStudio.probes.axial.screen('angle')")
        page.mouse.move(at["x"], at["y"])
        save(page, "studio-bend", (900, 562))


def sites(browser) -> None:
    """How far one site of an egg reaches."""
    with shown(browser, sited_egg(), "egg", "sites") as page:
        wait(page, "window.pliantStudio.probes.sites.count() === 30")
        page.evaluate("window.pliantStudio.look(-0.7, -1, 0.25)")
        time.sleep(1)
        moves = page.evaluate("Array.from({length: 30}, (_, i) => window.pliantStudio.probes.sites.moved(i))")
        at = page.evaluate(f"window.pliantStudio.probes.sites.screen({int(np.argmax(moves))})")
        page.mouse.click(at["x"], at["y"])
        wait(page, "!document.querySelector('.legend').hidden")
        save(page, "studio-sites", (1000, 625))


def rounds(browser) -> None:
    """A vase in a cylinder, one ring of which is drawn in."""
    mesh = textured_vase()
    lattice = pl.ExtendedFFD.cylinder(mesh, shape=(8, 4, 7))
    ring = lattice.blocks[0].index[:, 3, 4]
    controls = np.array(lattice.rest)
    controls[ring] = lattice.rest[ring].mean(axis=0) + 0.35 * (lattice.rest[ring] - lattice.rest[ring].mean(axis=0))
    scene = pl.Scene(mesh, pl.Stack([pl.Layer("Cylinder", lattice.moved(controls))]))
    with shown(browser, scene, "vase", "points") as page:
        wait(page, "window.pliantStudio.controlPoint(0) !== null")
        page.get_by_label("A click takes").select_option("ring")
        at = page.evaluate(f"window.pliantStudio.controlPoint({int(ring[6])})")
        page.mouse.click(at["x"], at["y"])
        page.locator("canvas").first.focus()
        page.keyboard.press("s")
        time.sleep(1)
        save(page, "studio-rings", (780, 488))


def cages(browser) -> None:
    """A vase in a cage, one face selected, and how far other coordinates lead."""
    with shown(browser, caged_vase(), "vase", "cage") as page:
        wait(page, "document.querySelectorAll('.cage-report .good').length === 3")
        page.get_by_label("A click takes").select_option("face")
        page.get_by_role("button", name="Compare coordinates").click()
        wait(page, "document.querySelectorAll('.cage-row').length === 4")
        at = [page.evaluate(f"window.pliantStudio.probes.cage.screen({index})") for index in (4, 9, 14, 19)]
        page.mouse.click(np.mean([each["x"] for each in at]), np.mean([each["y"] for each in at]))
        page.mouse.move(60, 600)
        time.sleep(1)
        save(page, "studio-cage", (840, 525))


def coordinates(browser) -> None:
    """The same cage in the same pose under three kinds of coordinates."""
    with shown(browser, caged_vase(), "vase", "cage") as page:
        wait(page, "document.querySelectorAll('.cage-report .good').length === 3")
        page.get_by_label("Side by side").select_option("green")
        page.get_by_label("And beside").select_option("harmonic")
        wait(page, "document.querySelectorAll('.viewport.side').length === 2")
        time.sleep(3)
        page.evaluate("window.pliantStudio.look(-0.35, -1, 0.3)")
        page.mouse.move(60, 600)
        time.sleep(1)
        save(page, "studio-cage-beside", (840, 525))


def surfaces(browser) -> None:
    """A raised arm beside its skeleton, its handle held by the gizmo."""
    with shown(browser, raised_arm(), "arm", "surface") as page:
        wait(page, "window.pliantStudio.probes.surface.count('handle') > 0")
        page.get_by_role("radio", name="Beside").click()
        page.get_by_role("button", name="(G)").click()
        wait(page, "window.pliantStudio.probes.surface.nodes().length > 0")
        page.evaluate("window.pliantStudio.look(0.25, -1, 0.3)")
        time.sleep(1)
        save(page, "studio-surface", (1000, 625))


def transfers(browser) -> None:
    """A bar's poses on an arm, with the markers on both."""
    with shown(browser, pl.Scene(torus()), "arm", "transfer") as page:
        page.get_by_role("button", name="Try an example").click()
        wait(page, "window.pliantStudio.probes.transfer.state().markers.length === 16")
        page.get_by_role("button", name="Transfer the poses").click()
        wait(page, "window.pliantStudio.probes.transfer.state().ready")
        page.evaluate("window.pliantStudio.look(-0.3, -1, 0.35)")
        page.evaluate("window.pliantStudio.probes.transfer.lookAtSource(-0.3, -1, 0.35)")
        page.get_by_label("bent", exact=True).scroll_into_view_if_needed()
        time.sleep(2)
        save(page, "studio-transfer", (1000, 625))


def times(browser) -> None:
    """A tool on its way through a column, ghosts, and a curve."""
    with shown(browser, swallowing_column(), "column", "time") as page:
        wait(page, "document.querySelector('.ruler .playhead-grip') !== null")
        page.evaluate("window.pliantStudio.look(0.25, -1, 0.16)")
        page.locator(".track-row", has_text="Bulge").locator(".track-name").click()
        page.get_by_role("button", name="Place the tool").click()
        page.get_by_role("button", name="Onion skin").click()
        page.get_by_label("every", exact=True).select_option("8")
        seek(page, 1.0)
        wait(page, "window.pliantStudio.probes.time.ghosts() === 4")
        save(page, "studio-time", (1000, 625))
        page.get_by_role("button", name="Onion skin").click()
        page.get_by_role("button", name="Place the tool").click()
        page.get_by_role("radio", name="Curves").click()
        page.locator("[data-track='Sway/angle'] .track-name").click()
        page.locator(".curve-area .key").nth(2).click()
        time.sleep(1)
        save(page, "studio-curves", (1000, 625))


def seek(page, moment: float) -> None:
    """The playhead to a moment."""
    box = page.locator(".ruler").bounding_box()
    page.mouse.click(box["x"] + page.evaluate(f"window.pliantStudio.probes.time.x({moment})"), box["y"] + 12)
    wait(page, f"Math.abs(window.pliantStudio.probes.time.time() - {moment}) < 0.03")


def gallery(browser) -> None:
    """Templates on the vase."""
    with shown(browser, pl.Scene(textured_vase()), "vase", "time") as page:
        page.evaluate("window.pliantStudio.look(0.4, -1, 0.3)")
        page.get_by_role("button", name="Templates").click()
        wait(page, "document.querySelectorAll('.template-card.drawn').length >= 16")
        page.locator("[data-template='corkscrew']").click()
        page.mouse.move(5, 5)
        save(page, "studio-templates", (1000, 625))


def wait(page, script: str) -> None:
    """Until a script is true on the page, and drawn."""
    for _ in range(600):
        if page.evaluate(script):
            time.sleep(1)
            return
        time.sleep(0.05)
    sys.exit(f"never: {script}")


def save(page, name: str, size=(1280, 800)) -> None:
    """A screenshot, at two thirds of the pixels that it was taken in or less: smooth, and small enough to be kept."""
    picture = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
    picture.resize(size, Image.Resampling.LANCZOS).save(OUT / f"{name}.png", optimize=True)


def clip(page) -> None:
    """A control point is dragged in a loop."""
    at = page.evaluate("window.pliantStudio.controlPoint(74)")
    page.mouse.move(at["x"], at["y"])
    page.mouse.down()
    frames = []
    for turn in np.linspace(0, 2 * np.pi, 17)[:-1]:
        page.mouse.move(at["x"] + 60 * np.sin(turn), at["y"] - 70 * (1 - np.cos(turn)) / 2)
        time.sleep(0.15)
        data = page.screenshot(clip={"x": 46, "y": 46, "width": 542, "height": 528})
        frames.append(Image.open(io.BytesIO(data)).convert("RGB").quantize(96, dither=Image.Dither.NONE))
    page.keyboard.press("Escape")
    page.mouse.up()
    frames[0].save(OUT / "studio.gif", save_all=True, append_images=frames[1:], duration=80, loop=0, optimize=True)


PICTURES = {
    "lattices": lattices,
    "models": models,
    "faces": faces,
    "bends": bends,
    "sites": sites,
    "rounds": rounds,
    "cages": cages,
    "coordinates": coordinates,
    "surfaces": surfaces,
    "transfers": transfers,
    "times": times,
    "gallery": gallery,
}

if __name__ == "__main__":
    main(sys.argv[1:])
