"""A studio on a free port, and a real browser in front of it."""

import shutil
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from browser import FLAGS, View


@pytest.fixture(scope="session")
def browser():
    from playwright.sync_api import sync_playwright

    program = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    assert program, "these tests drive a real browser: apt-get install chromium"
    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=program, args=FLAGS)
        yield running
        running.close()


@pytest.fixture
def launched(tmp_path):
    """Start studios; they end with the test."""
    from pliant.studio.launching import launch

    running = []

    def start(scene=None, name="shape", **options):
        root = options.pop("root", tmp_path / "root")
        root.mkdir(exist_ok=True)
        found = launch(scene, name if scene else "", port=0, root=root, autosave=tmp_path / "state", **options)
        found.start()
        running.append(found)
        return found

    yield start
    for each in running:
        each.stop()


@pytest.fixture
def view(browser):
    """Open pages on studios; a page that has complained of anything fails its test."""
    contexts, complaints = [], []

    def look(studio, **options):
        context = browser.new_context(viewport={"width": 1000, "height": 640}, **options)
        context.set_default_timeout(15_000)
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("console", lambda said: complaints.append(said.text) if said.type == "error" else None)
        page.goto(f"{studio.url}&antialias=off")
        return View(page, studio, complaints)

    yield look
    for context in contexts:
        context.close()
    assert not complaints
