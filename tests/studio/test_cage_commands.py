"""Cages in the studio: built, verified, exchanged and compared, against the library and without a browser."""

import time
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
from pages import joined

import pliant as pl
from pliant.cages.checking import check_cage
from pliant.scene.project import load_project, save_project
from pliant.studio.examples.samples import bar, egg, torus
from pliant.studio.modes.caging import plane_across, told

EGG, BAR = egg(40, 24), bar()
session_on = contextmanager(joined)


def waited(session, ready):
    """Wait for what a job brings about on the session's thread."""
    end = time.monotonic() + 30
    while not (found := session.submit(ready).result()):
        assert time.monotonic() < end, "the job brought nothing about"
        time.sleep(0.01)
    return found


def caged(mesh, coordinates="mean_value", cells=(2, 2, 2)):
    cage = pl.Cage(pl.cage_from_box(mesh, cells), coordinates=coordinates)
    moved = np.array(cage.rest)
    moved[moved[:, 2] > mesh.center[2]] += [0.2, 0.1, 0.3]
    return pl.Scene(mesh, pl.Stack([pl.Layer("Cage", cage.moved(moved))]))


@pytest.mark.parametrize("values", [{"method": "offset", "vertices": 60}, {"method": "box", "vertices": 40}])
def test_a_cage_that_is_built_is_a_layer_that_moves_nothing_and_survives_saving(values, tmp_path):
    with session_on(pl.Scene(EGG), "egg") as (session, page):
        session.submit(page.ask, session, "cage.build", {**values, "coordinates": "mean_value"}).result()
        waited(session, lambda: session.scene.stack.names)
        cage = session.scene.stack["Cage"].deformer
        assert len(cage.mesh.points) <= values["vertices"]
        report = check_cage(cage.mesh, EGG)
        assert (report.manifold, report.crossed, report.outside, report.through) == (True, 0, 0, 0)
        np.testing.assert_allclose(session.stage.binding.result, EGG.points, atol=1e-9)
        waited(session, lambda: page.events("progress-end"))
        parts = [frame.head["part"] for frame in page.events("progress") if frame.head["part"] is not None]
        assert parts == sorted(parts)
        if values["method"] == "offset":
            assert 0.5 < parts[-1] < 1
        index = np.array([3], np.uint32)
        page.ask(session, "points.set", {"layer": "Cage"}, index=index, positions=cage.rest[3] + [0.3, 0.0, 0.2])
        save_project(session.scene, tmp_path / "egg.pliant")
        again = load_project(tmp_path / "egg.pliant").deformed().points
        np.testing.assert_allclose(again, session.stage.binding.result, atol=1e-9)


def test_a_line_drawn_across_a_bar_is_the_plane_through_it_along_the_view():
    eye = np.array([0.7, -12.0, 0.4])
    first, second = ([*eye, *(np.array([0.7, -0.4, height]) - eye)] for height in (-1.0, 1.0))
    cut = plane_across(BAR, np.array([0.7, 0.05, 0.0]), np.array(first), np.array(second))
    assert abs(cut.normal[0]) == pytest.approx(1.0)
    np.testing.assert_allclose(cut.origin, [0.7, 0.0, 0.0], atol=1e-9)  # the middle of the section


def test_planes_make_a_cage_as_the_library_s_builder_does():
    cuts = np.array([[x, 0.0, 0.0, 1.0, 0.0, 0.0] for x in (-1.5, 0.0, 1.5)])
    builder = pl.CageBuilder(BAR, 5, 0.03)
    for cut in cuts:
        builder = builder.cut(cut[:3], cut[3:])
    with session_on(pl.Scene(BAR), "bar") as (session, page):
        values = {"method": "cuts", "margin": 0.03, "sides": 5}
        shown = page.ask(session, "cage.sketch", values, cuts=cuts.reshape(-1))
        assert shown.head["linked"]
        np.testing.assert_allclose(shown.arrays["points"].reshape(-1, 3), builder.rough().points, atol=1e-6)
        session.submit(lambda: page.ask(session, "cage.build", values, cuts=cuts.reshape(-1))).result()
        waited(session, lambda: session.scene.stack.names)
        expected = builder.build(vertices=150).points
        np.testing.assert_allclose(session.scene.stack["Cage"].deformer.rest, expected, atol=1e-12)


def test_planes_without_a_ring_are_told():
    cuts = np.array([[0.0, 0.0, 0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0, 0.0, 0.3], [9.0, 0.0, 0.0, 1.0, 0.0, 0.0]])
    with session_on(pl.Scene(BAR), "bar") as (session, page):
        values = {"method": "cuts", "margin": 0.05}
        session.submit(lambda: page.ask(session, "cage.build", values, cuts=cuts.reshape(-1))).result()
        told_planes = waited(session, lambda: page.events("cage-planes"))[0].head
        assert told_planes["layer"] == "Cage"
        assert told_planes["left_out"] == ["1: it crosses another plane on the shape", "2: it misses the shape"]
        cage = session.scene.stack["Cage"].deformer
        assert check_cage(cage.mesh, BAR).ok
        assert np.count_nonzero(np.abs(cage.rest[:, 0]) < 1e-9) == 6  # the ring is in its plane


def test_planes_that_cannot_be_linked_show_their_rings_and_say_why():
    ring = torus(48, 20)
    with session_on(pl.Scene(ring), "ring") as (session, page):
        values = {"method": "cuts", "margin": 0.03, "sides": 6}
        shown = page.ask(session, "cage.sketch", values, cuts=np.array([1.0, 0.0, 0.0, 0.0, 1.0, 0.0]))
        assert not shown.head["linked"]
        assert "separates nothing" in shown.head["message"]
        points = shown.arrays["points"].reshape(-1, 3)
        assert len(points) == 6
        np.testing.assert_allclose(points[:, 1], 0.0, atol=1e-6)  # in the plane
        assert np.linalg.norm(points - [1.0, 0.0, 0.0], axis=1).min() > 0.38  # around the tube


def test_coordinates_are_exchanged_on_the_same_edit_and_verified():
    scene = caged(EGG)
    with session_on(scene, "egg") as (session, page):
        values = {"layer": "Cage", "coordinates": "green"}
        session.submit(page.ask, session, "cage.coordinates", values).result()
        waited(session, lambda: session.scene is not scene)
        green = session.scene.stack["Cage"].deformer
        assert green.coordinates == "green"
        np.testing.assert_array_equal(green.controls, scene.stack["Cage"].deformer.controls)
        np.testing.assert_allclose(session.stage.binding.result, green(EGG.points), atol=1e-9)
        session.submit(page.ask, session, "cage.check", {"layer": "Cage"}).result()
        waited(session, lambda: page.events("cage-report"))
        assert page.events("cage-report")[0].head["report"] == told(check_cage(green.mesh, EGG))


def test_a_comparison_says_how_far_and_how_much_volume():
    scene = caged(EGG)
    with session_on(scene, "egg") as (session, page):
        kinds = ["mean_value", "green"]
        session.submit(page.ask, session, "cage.compare", {"layer": "Cage", "kinds": kinds}).result()
        waited(session, lambda: page.events("cage-comparison"))
        same, green = page.events("cage-comparison")[0].head["rows"]
        assert same["away"] == 0.0
        other = replace(scene.stack["Cage"].deformer, coordinates="green")(EGG)
        away = np.linalg.norm(other.points - scene.deformed().points, axis=1)
        assert green["away"] == pytest.approx(away.max() / EGG.diagonal)
        assert green["volume"] == pytest.approx(pl.volume(other) / pl.volume(EGG))
        shown = page.ask(session, "cage.other", {"coordinates": "green"})
        np.testing.assert_allclose(shown.arrays["values"], away, atol=1e-6)
        page.ask(session, "layers.mute", {"layer": "Cage", "muted": True})
        assert "compare again" in page.refused(session, "cage.other", {"coordinates": "green"})["message"]


def test_building_that_is_stopped_changes_nothing():
    with session_on(pl.Scene(EGG), "egg") as (session, page):
        session.submit(page.ask, session, "cage.build", {"method": "offset", "vertices": 200}).result()
        job = page.events("progress")[0].head["job"]
        session.submit(page.ask, session, "job.cancel", {"job": job}).result()
        done = []
        session.jobs.run("after", lambda _: None, done.append)  # jobs are done one after another
        waited(session, lambda: done)
        assert not session.scene.stack.names
        assert not page.events("failure")


def test_faces_of_a_cage_are_told_whole():
    with session_on(caged(EGG), "egg") as (session, page):
        told_faces = page.ask(session, "cage.get", {"layer": "Cage"})
        faces = session.scene.stack["Cage"].deformer.mesh.faces
        np.testing.assert_array_equal(told_faces.arrays["faces"], faces.flat)
        np.testing.assert_array_equal(told_faces.arrays["offsets"], faces.offsets)


def test_requests_for_cages_that_make_no_sense_are_refused():
    scene = pl.Scene(EGG, pl.Stack([pl.Layer("Twist", pl.Twist.around(EGG))]))
    with session_on(scene, "egg") as (session, page):
        for command, values, word in (
            ("cage.build", {"vertices": 3}, "8 to"),
            ("cage.build", {"method": "magic"}, "magic"),
            ("cage.build", {"coordinates": "polar"}, "polar"),
            ("cage.get", {"layer": "Twist"}, "no cage"),
            ("cage.compare", {"layer": "Twist", "kinds": []}, "no cage"),
            ("cage.cut", {"inside": [0, 0, 0], "first": [0] * 6, "second": [0] * 5}, "6"),
            ("cage.cut", {"inside": [0, 0, 0], "first": [0, -9, 0, 0, 1, 0], "second": [0, -9, 0, 0, 1, 0]}, "short"),
        ):
            assert word in page.refused(session, command, values)["message"], command
        assert "six numbers" in page.refused(session, "cage.sketch", {}, cuts=np.zeros(9))["message"]


def test_other_coordinates_beside_follow_a_drag_as_the_library_says():
    scene = caged(EGG)
    cage = scene.stack["Cage"].deformer
    with session_on(scene, "egg") as (session, page):
        values = {"layer": "Cage", "coordinates": "green"}
        assert not page.ask(session, "cage.beside_at", values).arrays  # not computed yet
        session.submit(page.ask, session, "cage.beside", values).result()
        waited(session, lambda: page.events("cage-beside"))

        def beside(moved):
            shown = session.submit(page.ask, session, "cage.beside_at", values).result().arrays
            expected = replace(cage, coordinates="green").moved(moved)(EGG)
            np.testing.assert_allclose(shown["positions"].reshape(-1, 3), expected.points, atol=1e-6)
            assert len(shown["normals"]) == 3 * len(EGG.points)

        beside(cage.controls)
        session.submit(page.ask, session, "drag.begin", {"layer": "Cage"}).result()
        moved = np.array(cage.controls)
        moved[5] += [0.3, -0.2, 0.1]
        index = np.array([5], np.uint32)
        session.submit(lambda: page.ask(session, "drag.move", {}, index=index, positions=moved[5])).result()
        beside(moved)
        assert session.scene is scene  # while the drag lasts
        session.submit(page.ask, session, "drag.cancel", {}).result()
        beside(cage.controls)
        other = pl.Cage(pl.cage_from_box(EGG, (1, 1, 1)))
        stack = scene.stack.replace("Cage", deformer=other)
        session.submit(session.commit, scene.replace(stack=stack), "cage").result()
        assert not page.ask(session, "cage.beside_at", values).arrays  # those of another cage
