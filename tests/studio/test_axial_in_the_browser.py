"""Bends and twists by hand in a real browser, against what the library computes."""

import time

import numpy as np
import pytest
from test_in_the_browser import same_points

import pliant as pl
from pliant.studio.examples.samples import bar


def at(page, name):
    page.until("!window.pliantStudio.probes.axial.adding()")
    page.until(f"window.pliantStudio.probes.axial.screen('{name}') !== null")
    page.settled()
    place = page.ask(f"window.pliantStudio.probes.axial.screen('{name}')")
    return place["x"], place["y"]


def entered(page):
    page.drawn()
    page.ask("window.pliantStudio.mode('axial')")
    page.ask("window.pliantStudio.look(0.5, -1, 0.5)")
    page.settled()


def test_a_twist_is_added_turned_and_bent_by_its_handles(launched, view):
    page = view(launched(pl.Scene(bar())))
    entered(page)
    revision = page.session.revision
    page.page.get_by_role("button", name="Twist", exact=True).click()
    page.committed(revision)
    page.page.get_by_role("radio", name="x", exact=True).click()
    page.committed(revision + 1)
    start = at(page, "angle")
    page.drag(start, (-4, -40), steps=8)
    page.committed(revision + 2)
    twist = page.session.scene.stack["Twist"].deformer
    assert twist.axis == "x"
    assert 0.3 < twist.angle < 2.0
    x, y = at(page, "angle")
    assert np.hypot(x - start[0] + 4, y - start[1] + 40) < 8  # it stays under the pointer, on its circle
    same_points(page)
    page.page.get_by_role("button", name="Bend", exact=True).click()
    page.committed(revision + 3)
    the_handles_are_on_the_canvas(page)
    page.page.get_by_role("radio", name="y", exact=True).click()
    page.committed(revision + 4)
    page.ask("window.pliantStudio.look(0.5, -1, 0.5)")  # the page has stepped back, to show the handles of the bend
    start = at(page, "angle")
    page.drag(start, (40, -110), steps=8)
    page.committed(revision + 5)
    x, y = at(page, "angle")
    assert np.hypot(x - start[0] - 40, y - start[1] + 110) < 25
    same_points(page)
    page.picture("bend-and-twist")
    clay = page.pixels(*map(int, at(page, "angle")), 3, 3).reshape(-1, 3).mean(axis=0)
    assert clay[0] > 180 > 120 > clay[2]  # the handle is red
    page.page.get_by_role("button", name="Mute", exact=True).first.click()
    page.committed(revision + 6)
    np.testing.assert_allclose(page.positions(40), twist(page.session.scene.mesh.points[:40]), atol=1e-5)


def the_handles_are_on_the_canvas(page):
    """Clear of its edges, and of the bar above it."""
    box = page.page.locator(".viewport canvas").first.bounding_box()
    page.until("!window.pliantStudio.probes.axial.adding()")
    for name in page.ask("window.pliantStudio.probes.axial.names()"):
        x, y = at(page, name)
        assert box["x"] < x < box["x"] + box["width"]
        assert box["y"] + 50 < y < box["y"] + box["height"]


def test_control_snaps_a_twist_to_fifteen_degrees_and_escape_gives_it_back(launched, view):
    scene = pl.Scene(bar(), pl.Stack([pl.Layer("Twist", pl.Twist.around(bar(), axis="x"))]))
    page = view(launched(scene))
    entered(page)
    revision = page.session.revision
    page.page.keyboard.down("Control")
    page.drag(at(page, "angle"), (-20, -80), steps=6)
    page.page.keyboard.up("Control")
    page.committed(revision)
    turns = page.session.scene.stack["Twist"].deformer.angle / (np.pi / 12)
    assert turns == pytest.approx(round(turns))
    assert round(turns) > 1
    shown = page.positions(30)
    page.drag(at(page, "axis"), (-10, 60), steps=6, release=False)
    page.until(f"Math.abs(window.pliantStudio.position(0)[2] - ({shown[0, 2]})) > 0.001")
    page.page.keyboard.press("Escape")
    page.page.mouse.up()
    end = time.monotonic() + 15  # giving up is no entry of the history: there is no revision to wait for
    while not np.allclose(page.positions(30), shown, atol=1e-5):
        assert time.monotonic() < end, "the shape did not go back"
        time.sleep(0.05)
    assert page.session.revision == revision + 1


def test_an_axis_is_bent_segment_by_segment(launched, view):
    page = view(launched(pl.Scene(bar())))
    entered(page)
    revision = page.session.revision
    page.page.get_by_role("button", name="Bend segment by segment").click()
    page.committed(revision)
    page.page.get_by_role("radio", name="x", exact=True).click()
    page.committed(revision + 1)
    page.ask("window.pliantStudio.look(0.5, -1, 0.5)")
    start = at(page, "#4")
    page.drag(start, (8, -40), steps=6)
    page.committed(revision + 2)
    x, y = at(page, "#4")
    assert np.hypot(x - start[0] - 8, y - start[1] + 40) < 8  # under the pointer
    (layer,) = page.session.scene.stack
    rates = np.array(layer.deformer.rates)
    assert np.flatnonzero(rates.any(axis=1)).tolist() == [3]
    same_points(page)
    page.until("document.querySelectorAll('.rate-row rect').length === 32")
    bars = page.page.locator(".rate-row svg").nth(2).bounding_box()
    across = (bars["x"] + 0.5 * bars["width"] / 8, bars["y"] + 0.25 * bars["height"])
    page.drag(across, (bars["width"] * 7 / 8, 0), steps=30)  # over all eight: half of their height, which is 60 degrees
    page.committed(revision + 3)
    twisted = page.session.scene.stack[layer.name].deformer.rates
    np.testing.assert_allclose(twisted[:, 2], np.pi / 6, rtol=0.15)
    np.testing.assert_array_equal(np.delete(twisted, 2, axis=1), np.delete(rates, 2, axis=1))
    same_points(page)
    page.picture("segments")
