"""A studio on a free port, and a real browser in front of it."""

import shutil
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from browser import FLAGS, View

SIZE = {"width": 1000, "height": 640}


@pytest.fixture(scope="session")
def browser():
    from playwright.sync_api import sync_playwright

    program = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    assert program, "these tests drive a real browser: apt-get install chromium"
    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=program, args=FLAGS)
        yield running
        running.close()


@pytest.fixture(scope="session")
def shared(tmp_path_factory):
    """One studio for all tests that need no other: each begins a scene of its own."""
    from pliant.studio.serving.launching import launch

    folder = tmp_path_factory.mktemp("studio")
    studio = launch(port=0, root=folder, autosave=folder / "state")
    studio.start()
    yield studio
    studio.stop()


@pytest.fixture
def launched(shared, tmp_path):
    """A studio on a scene; with ``own`` one that shares nothing with other tests."""
    from pliant.studio.serving.launching import launch

    running = []

    def start(scene=None, *, own=False):
        if not own:
            session = shared.session
            session.submit(*((session.close,) if scene is None else (session.begin, scene, "shape"))).result()
            return shared
        found = launch(scene, "shape" if scene else "", port=0, root=tmp_path, autosave=tmp_path / "state")
        found.start()
        running.append(found)
        return found

    yield start
    for each in running:
        each.stop()


@pytest.fixture(scope="session")
def usual(browser):
    context = browser.new_context(viewport=SIZE)
    yield context
    context.close()


@pytest.fixture
def view(browser, usual):
    """Open pages on studios; a page that has complained of anything fails its test."""
    opened, complaints = [], []

    def look(studio, **options):
        context = browser.new_context(viewport=SIZE, **options) if options else usual
        page = context.new_page()
        opened.append(context if options else page)
        page.set_default_timeout(15_000)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("console", lambda said: complaints.append(said.text) if said.type == "error" else None)
        page.goto(f"{studio.url}&antialias=off&guides=off")
        return View(page, studio, complaints)

    yield look
    for each in opened:
        if hasattr(each, "evaluate") and not each.is_closed():
            each.evaluate("localStorage.clear()")  # the next page has no settings of its own yet
        each.close()
    assert not complaints
