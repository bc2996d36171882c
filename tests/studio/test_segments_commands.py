"""Handles of tangent frames: the end of a segment stays under the pointer, and the twist is shared by all."""

from contextlib import contextmanager

import numpy as np
import pytest
from pages import joined

import pliant as pl
from pliant.studio.examples.samples import bar
from pliant.studio.modes.axial.following import Ray, followed
from pliant.studio.modes.axial.handles import handles_of
from pliant.studio.modes.axial.tool import Tool, size_of

session_on = contextmanager(joined)
MESH = bar()
EYE = np.array([3.0, -9.0, 5.0])
RATES = np.tile([0.1, -0.05, 0.2, 0.05], (5, 1))


def tool(rates=RATES):
    deformer = pl.TangentFrames.around(MESH, axis="x", rates=rates)
    return Tool(deformer, size_of(deformer, MESH.points))


def named(held, name):
    return next(each for each in handles_of(held) if each.name == name)


def towards(place):
    return Ray(EYE, (place - EYE) / np.linalg.norm(place - EYE))


@pytest.mark.parametrize("shift", [[0.0, 0.1, 0.3], [0.25, 0.0, 0.1], [-0.2, -0.1, -0.1]])
@pytest.mark.parametrize("name", ["#1", "#3", "#5"])
def test_the_end_of_a_segment_is_bent_and_stretched_to_the_pointer(name, shift):
    start = tool()
    handle = named(start, name)
    ray = towards(handle.place(start)[0] + shift)
    found = followed(start, handle, ray)
    assert np.linalg.norm(ray.miss(handle.place(found)[0])) < 1e-3 * start.size
    changed = np.flatnonzero((found.deformer.rates != start.deformer.rates).any(axis=1))
    assert changed.tolist() == [int(name[1:]) - 1]  # its own segment only
    assert found.deformer.rates[int(name[1:]) - 1, 2] == 0.2  # which is not twisted for it


def test_the_twist_is_shared_by_all_segments():
    start = tool()
    handle = named(start, "twist")
    wanted = handle.write(start, np.array([1.6]))
    found = followed(start, handle, towards(handle.place(wanted)[0]))
    np.testing.assert_allclose(found.deformer.rates[:, 2], 1.6 / 5, atol=1e-3)
    np.testing.assert_array_equal(found.deformer.rates[:, [0, 1, 3]], start.deformer.rates[:, [0, 1, 3]])


def test_many_segments_have_handles_that_can_be_told_apart():
    names = [each.name for each in handles_of(tool(np.zeros((100, 4))))]
    assert len(names) < 25
    assert names[0] == "#1"
    assert "#100" in names


def test_rates_are_told_and_set_as_numbers():
    with session_on(pl.Scene(MESH), "bar") as (session, page):
        page.ask(session, "layers.add", {"kind": "tangent-frames", "fields": {"axis": "x"}})
        layer = session.scene.stack.names[0]
        told = page.ask(session, "axial.get", {"layer": layer})
        assert told.arrays["rates"].reshape(-1, 4).tolist() == np.zeros((8, 4)).tolist()
        page.ask(session, "layers.fields", {"layer": layer, "fields": {"rates": RATES.tolist()}})
        made = session.scene.stack[layer].deformer
        np.testing.assert_array_equal(made.rates, RATES)
        np.testing.assert_allclose(session.shown.binding.result, made(MESH.points), atol=1e-12)
        bent = page.ask(session, "axial.get", {"layer": layer}).arrays["values"][0]
        assert bent == pytest.approx(np.hypot(0.1, 0.05))
        for wrong, cause in (([[0, 0, 0, -2]], "above -1"), ([[0, 0, 0]], "(k, 4)"), ([["a", 0, 0, 0]], "cannot be")):
            told = page.refused(session, "layers.fields", {"layer": layer, "fields": {"rates": wrong}})
            assert cause in told["message"]
