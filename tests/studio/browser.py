"""What tests do in a browser: wait, look at pixels, drag, and read the page's own handle."""

import time
from pathlib import Path

import numpy as np

FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
PICTURES = Path(__file__).parent / "pictures"  # looked at by people; not in the repository


class View:
    """A page on a studio."""

    def __init__(self, page, studio, complaints):
        self.page, self.studio, self.complaints = page, studio, complaints
        self.until("window.pliantStudio !== undefined && document.querySelector('.link.open') !== null")

    @property
    def session(self):
        return self.studio.session

    def ask(self, script):
        return self.page.evaluate(script)

    def until(self, script, patience=15.0):
        """Wait until a script is true: the page's policy forbids it to evaluate strings itself."""
        self._wait(lambda: self.page.evaluate(script), patience, script)

    def _wait(self, condition, patience, words):
        end = time.monotonic() + patience
        while time.monotonic() < end:
            if condition():
                return
            time.sleep(0.02)
        raise AssertionError(f"never came true: {words}")

    def drawn(self):
        """Wait until a mesh is there, and all that was asked for has been drawn."""
        shown = "document.querySelector('.start').hidden && window.pliantStudio.frames > 1"
        self.until(shown, patience=60)  # the first page of a browser translates its shaders first
        self.settled(patience=60)

    def settled(self, patience=15.0):
        """Wait until the page shows what the session shows, and draws no more."""
        page = lambda: self.page.evaluate("window.pliantStudio.revision")  # noqa: E731
        self._wait(lambda: page() == self.session.revision, patience, "the page shows the session's revision")
        self.until("!window.pliantStudio.waiting", patience)
        before = -1
        while before != (now := self.ask("window.pliantStudio.frames")):
            before = now
            time.sleep(0.08)

    def handles(self):
        """Wait until control points can be taken hold of."""
        self.until("window.pliantStudio.controlPoint(0) !== null")
        self.settled()

    def control(self, index):
        """Where a control point is on the page."""
        at = self.ask(f"window.pliantStudio.controlPoint({index})")
        return at["x"], at["y"]

    def drag(self, start, by, steps=5, release=True):
        x, y = start
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        self.page.mouse.move(x + by[0], y + by[1], steps=steps)
        if release:
            self.page.mouse.up()

    def committed(self, revision):
        """Wait until the session has gone on."""
        end = time.monotonic() + 15
        while self.session.revision <= revision:
            assert time.monotonic() < end, "nothing was committed"
            time.sleep(0.02)
        self.settled()

    def positions(self, count):
        """(count, 3) where the page draws the first points."""
        found = self.ask(f"Array.from({{length: {count}}}, (_, i) => window.pliantStudio.position(i))")
        return np.array(found)

    def picture(self, name):
        """A screenshot, kept for people."""
        PICTURES.mkdir(exist_ok=True)
        self.page.screenshot(path=PICTURES / f"{name}.png")

    def pixels(self, x, y, width=1, height=1):
        """(height, width, 3) colours of a rectangle of the canvas, the first row below."""
        found = self.ask(f"window.pliantStudio.pixels({x}, {y}, {width}, {height})")
        return np.array(found).reshape(height, width, 4)[..., :3]
