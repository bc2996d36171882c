"""The timeline in a real browser, against the library's own clip."""

import time as clock

import numpy as np

import pliant as pl
from pliant.scene.scene import Scene
from pliant.studio.examples.samples import bar


def moving_scene(fps=10.0, ending="once"):
    """A bar that is bent while time goes on, and wrung in between."""
    mesh = bar(along=30, across=6)
    stack = pl.Stack(
        [
            pl.Layer("Bend", pl.Bend.around(mesh, axis="y", angle=0.0)),
            pl.Layer("Twist", pl.Twist.around(mesh, axis="x", angle=0.0)),
        ]
    )
    clip = pl.Clip(mesh, stack, duration=2.0, fps=fps, ending=ending)
    clip = clip.key("Bend", 0.0, {"angle": 0.0}).key("Bend", 2.0, {"angle": 1.4}, easing="ease_in_out")
    clip = clip.key("Twist", 0.5, {"angle": 0.0}).key("Twist", 1.5, {"angle": 1.8}, easing=(0.3, -0.3, 0.5, 1.3))
    return Scene(mesh, stack, clip)


def opened(launched, view, **options):
    page = view(launched(moving_scene(**options)))
    page.drawn()
    page.page.keyboard.press("t")
    page.until("document.querySelector('.ruler .playhead-grip') !== null")
    page.settled()
    return page


def ruler(page, time):
    """Where a time is on the page's ruler."""
    box = page.page.locator(".ruler").bounding_box()
    return box["x"] + page.ask(f"window.pliantStudio.probes.time.x({time})"), box["y"] + 14


def shows(page, time, tolerance):
    """The page draws the clip's moment."""
    expected = page.session.scene.clip.sample(time).points
    found = page.positions(len(expected))
    np.testing.assert_allclose(found, expected, atol=tolerance * page.session.scene.mesh.diagonal)


def test_scrubbing_shows_each_moment_and_ends_exactly(launched, view):
    page = opened(launched, view)
    page.page.mouse.move(*ruler(page, 0))
    page.page.mouse.down()
    page.page.mouse.move(*ruler(page, 1.2), steps=6)
    page.until("Math.abs(window.pliantStudio.probes.time.time() - 1.2) < 1e-9")
    page.settled()
    shows(page, 1.2, 1e-4)
    assert page.session.time == 0.0  # only this page looks there
    page.page.mouse.up()
    page.until("document.querySelector('[aria-label=\"Playhead\"].number').value === '1.2'")
    page.settled()
    assert page.session.time == 1.2
    shows(page, 1.2, 2e-7)
    page.picture("time")


def test_playing_follows_the_clock_and_what_was_played_needs_no_server(launched, view):
    page = opened(launched, view, ending="loop")
    page.page.keyboard.press(" ")
    page.until("window.pliantStudio.probes.time.kept() >= 18", patience=30)
    assert page.ask("window.pliantStudio.probes.time.playing()")
    page.page.keyboard.press(" ")
    page.until("!window.pliantStudio.probes.time.playing()")
    time = page.ask("window.pliantStudio.probes.time.time()")
    page.until("document.querySelector('.ruler .kept') !== null")
    end = clock.monotonic() + 15  # the session hears of the moment when the page has stopped: no revision tells
    while page.session.time != time:
        assert clock.monotonic() < end
        clock.sleep(0.02)
    page.settled()
    shows(page, time, 2e-7)


def test_keys_are_dragged_in_time_and_added_by_a_double_click(launched, view):
    page = opened(launched, view)
    key = page.page.locator('[data-key=\'["Bend","angle",2]\']')
    box = key.bounding_box()
    at = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    wide = ruler(page, 0.5)[0] - ruler(page, 0)[0]
    revision = page.session.revision
    page.drag(at, (-wide, 0))
    page.committed(revision)
    bend = page.session.scene.clip.tracks[0]
    assert [key.time for key in bend.keys] == [0.0, 1.5]
    assert page.session.revision == revision + 1  # one entry of the history
    row = page.page.locator("[data-track='Bend/angle']").bounding_box()
    page.page.mouse.dblclick(ruler(page, 1.0)[0], row["y"] + row["height"] / 2)
    page.committed(revision + 1)
    keys = page.session.scene.clip.tracks[0].keys
    assert [key.time for key in keys] == [0.0, 1.0, 1.5]
    assert float(keys[1].value) == float(bend.at(1.0))
    page.page.keyboard.press("Control+z")
    page.committed(revision + 2)
    assert [key.time for key in page.session.scene.clip.tracks[0].keys] == [0.0, 1.5]


def test_a_handle_of_a_curve_changes_the_way_between_two_keys(launched, view):
    page = opened(launched, view)
    page.page.mouse.click(*ruler(page, 1.0))
    page.until("window.pliantStudio.probes.time.time() === 1")
    page.page.locator("[data-track='Twist/angle'] .track-name").click()
    page.page.get_by_role("radio", name="Curves").click()
    page.page.locator(".curve-area .key").nth(1).click()
    box = page.page.locator("[data-handle='1-0']").bounding_box()
    revision = page.session.revision
    page.drag((box["x"] + box["width"] / 2, box["y"] + box["height"] / 2), (60, 25), release=False)
    page.until("window.pliantStudio.latencies.length > 0")
    page.settled()
    during = page.positions(len(page.session.scene.mesh.points))
    page.picture("curves")
    page.page.mouse.up()
    page.committed(revision)
    x1, y1, x2, y2 = page.session.scene.clip.tracks[1].keys[1].easing
    assert x1 > 0.5
    assert y1 < -0.3
    assert (x2, y2) == (0.5, 1.3)
    shows(page, 1.0, 2e-7)
    np.testing.assert_allclose(during, page.session.scene.clip.sample(1.0).points, atol=1e-3)
    drawn = page.ask("document.querySelector('.curve-area .curve').getAttribute('d').split(/[ML]/).length")
    assert drawn > 24


def test_a_control_point_dragged_while_recording_moves_in_time(launched, view):
    mesh = bar(along=24, across=4)
    page = view(launched(Scene(mesh, pl.Stack([pl.Layer("Lattice", pl.BSplineFFD.around(mesh, shape=(4, 4, 4)))]))))
    page.drawn()
    page.page.keyboard.press("t")
    page.page.get_by_role("button", name="Record").click()
    page.page.get_by_role("button", name="Keep the timeline open").click()
    page.page.mouse.click(*ruler(page, 2.0))
    page.page.keyboard.press("2")
    page.handles()
    assert page.page.locator(".dock").is_visible()
    page.until("document.querySelector('[aria-label=\"Playhead\"].number').value === '2'")
    revision = page.session.revision
    page.drag(page.control(63), (40, -60))
    page.committed(revision)
    (track,) = page.session.scene.clip.tracks
    assert [key.time for key in track.keys] == [0.0, 2.0]
    assert np.abs(np.asarray(track.keys[1].value) - track.keys[0].value).max() > 0.05
    shows(page, 2.0, 2e-6)


def test_ghosts_of_other_moments_are_seen_in_their_colours(launched, view):
    page = opened(launched, view)
    page.page.mouse.click(*ruler(page, 1.0))
    page.until("window.pliantStudio.probes.time.time() === 1")
    page.ask("window.pliantStudio.look(0, -1, 0.2)")
    page.settled()
    tip = int(np.argmax(page.session.scene.mesh.points[:, 0]))
    at = page.ask(f"window.pliantStudio.vertex({tip})")

    def around():
        return page.pixels(int(at["x"]) - 60, int(at["y"]) - 60, 90, 110).reshape(-1, 3).astype(int)

    plain = around()
    page.page.get_by_role("button", name="Onion skin").click()
    page.until("window.pliantStudio.probes.time.ghosts() === 4")
    page.settled()
    change = around() - plain
    teal = (change[:, 0] < change[:, 1] - 8).sum()  # less red than green: what was
    orange = (change[:, 2] < change[:, 0] - 8).sum()  # less blue than red: what comes
    assert min(teal, orange) > 60, (teal, orange)
    page.picture("onion")
