"""What people do by mistake: drags and picks that are given up leave no trace, and one drag is one entry."""

import json
import time

import numpy as np

from pliant.scene.scene import Scene
from pliant.studio.examples.samples import bar

PROBE = "window.pliantStudio.probes.surface"
BAR = bar()
END, LIMB = np.arange(59 * 40, 61 * 40), np.arange(40 * 40, 61 * 40)  # a handle at the end of a bar, and what bends


def opened(launched, view):
    """The end of the bar as a handle, recalled by name."""
    scene = Scene(BAR, selections={"end": END, "limb": LIMB})
    page = view(launched(scene))
    page.drawn()
    page.ask("window.pliantStudio.mode('surface')")
    page.ask("window.pliantStudio.look(0.2, -1, 0.35)")
    for part, name, count in (("region", "limb", len(LIMB)), ("handle", "end", len(END))):
        page.page.get_by_role("button", name=f"Take as the {part}: {name}").click()
        page.until(f"{PROBE}.count('{part}') === {count}")
    page.page.locator("canvas").first.focus()
    page.page.keyboard.press("g")
    page.settled()
    return page


def place(page, name="pivot"):
    at = page.ask(f"{PROBE}.{name}()")
    return at["x"], at["y"]


def held(page, by):
    """Hold the middle of the gizmo, and wait until the shape has moved."""
    before = page.ask("window.pliantStudio.latencies.length")
    page.drag(place(page), by, release=False)
    page.until(f"window.pliantStudio.latencies.length > {before}")


def at_rest(page):
    """Giving up is no entry of the history: there is no revision to wait for."""
    end = time.monotonic() + 30
    while not np.allclose(page.positions(len(BAR.points)), BAR.points, atol=1e-5) and time.monotonic() < end:
        time.sleep(0.05)
    page.settled()
    np.testing.assert_allclose(page.positions(len(BAR.points)), BAR.points, atol=1e-5)


def test_a_drag_that_is_given_up_leaves_no_trace(launched, view):
    page = opened(launched, view)
    revision, (x, y) = page.session.revision, place(page)
    for key in ("Escape", "Control+z"):  # what is in hand is given up, and nothing else
        held(page, (-20, -90))
        page.page.keyboard.press(key)
        at_rest(page)
        page.page.mouse.move(x + 80, y - 60, steps=3)  # the button is still down
        page.page.mouse.up()
        at_rest(page)
        np.testing.assert_allclose(place(page), (x, y), atol=1)
    assert page.session.revision == revision
    assert page.page.locator(".toast").count() == 0
    before = page.ask(f"{PROBE}.indices('region')")
    page.page.keyboard.press("e")
    vertex = page.ask(f"window.pliantStudio.vertex({20 * 40 + 35})")
    page.page.get_by_role("radio", name="Region", exact=True).click()
    page.drag((round(vertex["x"]), round(vertex["y"])), (40, 0), release=False)
    page.until(f"{PROBE}.count('handle') === 0")
    page.page.keyboard.press("Escape")
    page.page.mouse.up()
    assert page.ask(f"{PROBE}.indices('region')") == before
    assert page.ask(f"{PROBE}.count('handle')") == len(END)


def test_undo_right_after_a_drag_undoes_that_drag(launched, view):
    page = opened(launched, view)
    revision = page.session.revision
    held(page, (-20, -90))
    page.page.mouse.up()
    page.page.keyboard.press("Control+z")  # the drag is not an entry yet
    page.committed(revision + 1)
    at_rest(page)
    assert page.session.scene.stack.layers == ()
    page.page.keyboard.press("Control+y")
    page.committed(revision + 2)
    made = page.session.scene.stack["Edit"].deformer
    np.testing.assert_allclose(page.positions(len(BAR.points)), made(BAR).points, atol=1e-5)
    assert page.ask(f"{PROBE}.own()") == "Edit"


def test_the_middle_of_the_gizmo_scales_calmly_and_muted_edits_have_none(launched, view):
    page = opened(launched, view)
    page.page.keyboard.press("s")
    page.settled()
    revision, (x, y) = page.session.revision, place(page)
    page.drag((x + 1, y), (45, 0))  # a pixel beside the middle
    page.committed(revision)
    goal, rest = page.session.scene.stack["Edit"].deformer.goal, BAR.points[END]
    spread, before = (np.linalg.norm(each - each.mean(axis=0)) for each in (goal, rest))
    assert 1.1 < spread / before < 3
    page.page.get_by_role("button", name="Mute", exact=True).click()
    page.committed(revision + 1)
    revision = page.session.revision
    page.page.keyboard.press("g")
    page.settled()
    page.drag(place(page), (0, -60))  # turns the view
    page.settled()
    assert page.session.revision == revision
    assert page.session.scene.stack["Edit"].deformer.goal is goal
    assert "is muted" in page.page.locator(".surface-panel").inner_text()


def test_another_page_may_undo_what_this_one_holds(launched, view):
    page = opened(launched, view)
    page.page.get_by_label("Name of the selection").fill("kept")
    revision = page.session.revision
    page.page.keyboard.press("Enter")
    page.committed(revision)
    held(page, (-20, -90))
    page.session.submit(page.session.go, 0).result()  # as the other page's history does
    at_rest(page)
    x, y = place(page)
    page.page.mouse.move(x - 40, y - 60, steps=6)
    page.page.locator(".toast", has_text="drag again").wait_for()
    page.page.mouse.up()
    at_rest(page)
    assert page.page.locator(".toast").count() == 1
    assert page.session.scene.stack.layers == ()


def test_a_click_without_a_move_is_no_entry_and_a_page_goes_on_where_it_was(launched, view):
    page = opened(launched, view)
    revision = page.session.revision
    page.page.mouse.click(*place(page))
    page.settled()
    assert (page.session.revision, page.session.scene.stack.layers) == (revision, ())
    assert page.ask(f"{PROBE}.count('handle')") == len(END)
    page.page.keyboard.press("5")
    page.page.get_by_role("button", name="Twist", exact=True).click()
    page.committed(revision)
    page.until("window.pliantStudio.probes.axial.screen('angle') !== null")
    page.settled()
    revision, at = page.session.revision, page.ask("window.pliantStudio.probes.axial.screen('angle')")
    page.page.mouse.click(at["x"], at["y"])
    page.until("window.pliantStudio.probes.axial.screen('angle') !== null")
    page.page.reload()
    page.until("window.pliantStudio !== undefined")
    page.drawn()
    page.until("document.querySelector('.rail [aria-pressed=true]').dataset.mode === 'axial'")
    assert page.session.revision == revision


def test_markers_come_back_and_poses_that_play_are_given_up(launched, view):
    page = view(launched(Scene(BAR)))
    page.drawn()
    page.ask("window.pliantStudio.mode('transfer')")
    page.page.get_by_role("button", name="Try an example").click()
    probe = "window.pliantStudio.probes.transfer"
    page.until(f"{probe}.state().markers.length > 3")
    before = page.ask(f"{probe}.state().markers")
    for button in ("Delete 2", "Clear"):
        page.page.get_by_role("button", name=button, exact=True).click()
        page.until(f"{probe}.state().markers.length < {len(before)}")
        page.page.keyboard.press("Control+z")
        page.until(f"{probe}.state().markers.length === {len(before)}")
        assert page.ask(f"{probe}.state().markers") == before
    page.page.keyboard.press("Control+z")  # no change is left
    page.page.get_by_role("button", name="Transfer the poses").click()
    page.until(f"{probe}.state().ready", 60)
    page.until(f"{probe}.weights().length > 1")
    page.settled()
    revision, weights = page.session.revision, page.session.scene.stack["Poses"].deformer.controls
    page.page.locator("canvas").first.focus()
    page.page.keyboard.press("Space")
    page.until(f"{probe}.playing() && window.pliantStudio.latencies.length > 3")
    page.page.keyboard.press("Control+z")
    page.until(f"!{probe}.playing()")
    page.until(f"{json.dumps(weights.tolist())}.every((weight, i) => {probe}.weights()[i] === weight)")
    page.settled()
    assert page.session.revision == revision
    assert page.page.locator(".toast").count() == 0


def test_the_panel_says_what_is_still_to_be_picked(launched, view):
    page = view(launched(Scene(BAR, selections={"end": END, "limb": LIMB, "cut": LIMB[:400]})))
    page.drawn()
    page.ask("window.pliantStudio.mode('surface')")
    panel = page.page.locator(".surface-panel")
    panel.get_by_text("First pick what may bend").wait_for()
    steps = (
        ("region", "limb", "Now pick a handle"),
        ("handle", "end", "makes a new layer"),
        ("handle", "cut", "tear off"),
    )
    for part, name, says in steps:
        page.page.get_by_role("button", name=f"Take as the {part}: {name}").click()
        panel.get_by_text(says).wait_for()


def test_who_looks_for_a_sphere_finds_it_and_sees_all_of_it(launched, view):
    page = view(launched(Scene(BAR)))
    page.drawn()
    page.page.get_by_role("button", name="Add a deformer").click()
    search = page.page.get_by_placeholder("Search deformers")
    search.fill("no such thing")
    page.page.get_by_text("No deformer is called so.").wait_for()
    search.fill("sphere")
    page.page.keyboard.press("Enter")
    page.page.get_by_role("dialog", name="New round lattice").wait_for()
    page.page.get_by_role("radio", name="Sphere").click()
    page.page.get_by_text("127 control points").wait_for()
    revision = page.session.revision
    page.page.get_by_role("button", name="Create").click()
    page.committed(revision)
    page.handles()
    box = page.page.locator(".viewport canvas").first.bounding_box()
    for index in range(0, 127, 9):
        x, y = page.control(index)
        assert box["x"] < x < box["x"] + box["width"]
        assert box["y"] < y < box["y"] + box["height"]
