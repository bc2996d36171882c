"""The studio: what one move of a control point costs the server, how much travels, and how long until it is drawn.

    python benchmarks/studio.py [--browser]

The first table drives a session without a page. With ``--browser`` a real Chromium drags, its draw calls skipped:
what is timed is everything from the move to the moment of drawing.
"""

import argparse
import shutil
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from pliant.scene.clip import Clip
from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.space.bend import Bend
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.twist import Twist
from pliant.studio.examples.samples import torus
from pliant.studio.serving.launching import launch

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "studio"))
from browser import FLAGS

SIZES = {"35k": (268, 131), "200k": (640, 313), "1M": (1430, 700)}
LATTICES = ((8, 8, 8), (4, 4, 4))
GOALS = {("35k", (8, 8, 8)): "2 ms, 150 kB, 40 ms", ("200k", (8, 8, 8)): "6 ms, 800 kB, 80 ms"}


class Page:
    """A page that only counts what it is sent."""

    def __init__(self):
        self.last = 0

    def send(self, data):
        self.last = len(data)


def scene_of(size, shape):
    mesh = torus(*SIZES[size])
    return Scene(mesh, Stack((Layer("Lattice", BSplineFFD.around(mesh, shape=shape)),)))


def busiest(scene):
    """The control point that reaches most points of the mesh."""
    lattice = scene.stack["Lattice"].deformer
    middle = [n // 2 for n in lattice.shape]
    candidates = [(i, middle[1], middle[2]) for i in range(lattice.shape[0])]
    reach = [
        np.count_nonzero(np.linalg.norm(scene.mesh.points - lattice.rest[c], axis=1) < 2 * lattice.spacing.min())
        for c in candidates
    ]
    return int(np.ravel_multi_index(candidates[int(np.argmax(reach))], lattice.shape))


def server_side(size, shape, moves=60):
    """Median CPU milliseconds and bytes of a move."""
    import pliant.studio.commands  # noqa: F401
    from pliant.studio.serving.frames import Frame
    from pliant.studio.session import Session

    scene = scene_of(size, shape)
    session, page = Session(scene, "ring"), Page()
    session.clients.append(page)
    index, start = busiest(scene), scene.stack["Lattice"].deformer.rest.reshape(-1, 3)
    session.handle(page, Frame({"id": 0, "do": "drag.begin", "with": {"layer": "Lattice"}}).encode())
    cost, size_sent = [], []
    for move in range(moves):
        arrays = {"index": np.array([index], np.uint32), "positions": start[index] + [0, 0, 0.002 * move]}
        data = Frame({"id": move, "do": "drag.move", "with": {}}, arrays).encode()
        began = time.process_time()
        session.handle(page, data)
        cost.append(1000 * (time.process_time() - began))
        size_sent.append(page.last)
    session.end()
    return float(np.median(cost[5:])), float(np.median(size_sent[5:]))


def playing(size, moments=24):
    """Median CPU milliseconds and bytes of a frame that is played for the first time: two layers with keys."""
    import pliant.studio.commands  # noqa: F401
    from pliant.studio.serving.frames import Frame
    from pliant.studio.session import Session

    mesh = torus(*SIZES[size])
    stack = Stack(
        (Layer("Twist", Twist.around(mesh, axis="z", angle=0.0)), Layer("Bend", Bend.around(mesh, axis="y", angle=0.0)))
    )
    clip = Clip(mesh, stack, duration=1.0)
    for name in ("Twist", "Bend"):
        clip = clip.key(name, 0.0, {"angle": 0.0}).key(name, 1.0, {"angle": 0.6}, easing="ease_in_out")
    session, page = Session(Scene(mesh, stack, clip), "ring"), Page()
    session.clients.append(page)
    cost = []
    for moment in range(moments):
        data = Frame({"id": moment, "do": "time.frame", "with": {"time": (moment + 0.5) / moments}}).encode()
        began = time.process_time()
        session.handle(page, data)
        cost.append(1000 * (time.process_time() - began))
    session.end()
    return float(np.median(cost[3:])), page.last


def in_the_browser(browser, size, shape, moves=60):
    """Milliseconds from opening the page to the mesh, and the median from a move to its drawing."""
    scene = scene_of(size, shape)
    with tempfile.TemporaryDirectory() as folder:
        studio = launch(scene, "ring", port=0, autosave=Path(folder))
        studio.start()
        context = browser.new_context(viewport={"width": 1280, "height": 800})
        page = context.new_page()
        began = time.perf_counter()
        page.goto(f"{studio.url}&antialias=off&guides=off")
        while not page.evaluate("window.pliantStudio && window.pliantStudio.controlPoint(0) !== null"):
            time.sleep(0.01)
        opened = time.perf_counter() - began
        page.evaluate("window.pliantStudio.skipDrawing(true)")
        page.evaluate(f"window.pliantStudio.drag({busiest(scene)}, {moves}, [0, 0, 0.002])")
        median = float(np.median(page.evaluate("window.pliantStudio.latencies")[5:]))
        context.close()
        studio.stop()
    return 1000 * opened, median


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--browser", action="store_true")
    wanted = parser.parse_args()
    print("| mesh | lattice | server CPU, ms | updates a second | kB | goal |\n|---|---|---|---|---|---|")
    for size in SIZES:
        for shape in LATTICES:
            cost, sent = server_side(size, shape)
            goal = GOALS.get((size, shape), "")
            name, rate = " × ".join(map(str, shape)), 1000 / cost
            print(f"| {size} | {name} | {cost:.2f} | {rate:.0f} | {sent / 1000:.0f} | {goal} |")
    print("\n| mesh | a frame played for the first time, server CPU ms | kB | frames a second |\n|---|---|---|---|")
    for size in ("35k", "200k"):
        cost, sent = playing(size)
        print(f"| {size} | {cost:.1f} | {sent / 1000:.0f} | {1000 / cost:.0f} |")
    if not wanted.browser:
        return
    from playwright.sync_api import sync_playwright

    print("\n| mesh | lattice | page → mesh, ms | move → drawn, median ms |\n|---|---|---|---|")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        for size in ("35k", "200k"):
            for shape in LATTICES:
                opened, median = in_the_browser(browser, size, shape)
                print(f"| {size} | {' × '.join(map(str, shape))} | {opened:.0f} | {median:.0f} |")
        browser.close()


if __name__ == "__main__":
    sys.exit(main())
