"""Draws the pictures of the studio's page in the documentation: python tools/studio_pictures.py (needs chromium)."""

from __future__ import annotations

import io
import shutil
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from PIL import Image

import pliant as pl
from pliant.studio.launching import launch
from pliant.studio.samples import torus

OUT = Path(__file__).parents[1] / "docs" / "pictures"
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def main() -> None:
    """Draw them all."""
    mesh = torus(120, 52)
    lattice = pl.BSplineFFD.around(mesh, shape=(5, 5, 3), margin=0.08)
    controls = np.array(lattice.rest)
    controls[4, 3, 2] += [0.45, 0.3, 0.55]
    controls[0, 1, 2] += [-0.1, 0.0, 0.35]
    scene = pl.Scene(mesh, pl.Stack([pl.Layer("Lattice", lattice.moved(controls))]))
    from playwright.sync_api import sync_playwright

    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        studio = launch(scene, "torus", port=0, autosave=Path(folder))
        studio.start()
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        page = browser.new_page(viewport={"width": 1280, "height": 800}, device_scale_factor=1.5)
        page.goto(f"{studio.url}&guides=off")
        wait(page, "window.pliantStudio && window.pliantStudio.controlPoint(0) !== null")
        at = page.evaluate("window.pliantStudio.controlPoint(71)")
        page.mouse.click(at["x"], at["y"])
        save(page, "studio")
        page.get_by_label("Colour").select_option("displacement")
        page.get_by_label("Grid lines").check()
        page.evaluate("window.pliantStudio.mode('look')")
        time.sleep(2)
        page.get_by_label("Colour").scroll_into_view_if_needed()
        save(page, "studio-field")
        page.close()
        page = browser.new_page(viewport={"width": 900, "height": 600})
        page.goto(f"{studio.url}&guides=off")
        wait(page, "window.pliantStudio && window.pliantStudio.controlPoint(0) !== null")
        clip(page)
        browser.close()
        studio.stop()


def wait(page, script: str) -> None:
    """Until a script is true on the page, and drawn."""
    for _ in range(600):
        if page.evaluate(script):
            time.sleep(1)
            return
        time.sleep(0.05)
    sys.exit(f"never: {script}")


def save(page, name: str) -> None:
    """A screenshot, at two thirds of the pixels that it was taken in: smooth, and small enough to be kept."""
    picture = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
    picture.resize((1280, 800), Image.Resampling.LANCZOS).save(OUT / f"{name}.png", optimize=True)


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


if __name__ == "__main__":
    main()
