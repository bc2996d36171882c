"""Sites that are placed on the surface, and round lattices: against the library, without a browser."""

from contextlib import contextmanager

import numpy as np
import pytest
from pages import joined

import pliant as pl
from pliant.scene.project import load_project, save_project
from pliant.studio.examples.samples import ball, egg
from pliant.studio.modes.lattices import axes_of, links, places_around

MESH = egg()
THIRDS = [1 / 3, 1 / 3, 1 / 3]
session_on = contextmanager(joined)


def clicked(mesh, direction):
    """The triangle that lies farthest in a direction."""
    middles = mesh.points[mesh.triangles].mean(axis=1)
    return [int(vertex) for vertex in mesh.triangles[np.argmax(middles @ direction)]]


def placed(session, page, direction, layer="", **values):
    triangle = clicked(session.scene.mesh, np.array(direction))
    return page.ask(session, "sites.place", {"layer": layer, "triangle": triangle, "weights": THIRDS, **values})


def test_the_first_site_waits_and_the_second_makes_the_layer():
    with session_on(pl.Scene(MESH), "egg") as (session, page):
        first = placed(session, page, (0, -1, 0.2))
        assert first.head["layer"] == ""
        assert not session.scene.stack.names
        second = placed(session, page, (1, 0, 0))
        sites = session.scene.stack[second.head["layer"]].deformer
        np.testing.assert_allclose(sites.sites[0], first.arrays["waiting"], atol=1e-12)
        np.testing.assert_allclose(sites.sites[1], MESH.points[clicked(MESH, np.array([1, 0, 0]))].mean(axis=0))


def test_a_site_that_is_added_to_a_deformation_moves_nothing_where_it_stands():
    start = pl.DirichletFFD(MESH.points[[5, 700, 1500]])
    start = start.moved(start.rest + [[0.2, 0.1, 0], [0, 0, 0.3], [0, 0, 0]])
    scene = pl.Scene(MESH, pl.Stack([pl.Layer("Sites", start)]))
    with session_on(scene, "egg") as (session, page):
        answer = placed(session, page, (0, -1, 0.2), "Sites")
        after = session.scene.stack["Sites"].deformer
        new = after.sites[answer.head["site"]]
        assert np.linalg.norm(start(new[None]) - new) > 0.01
        np.testing.assert_allclose(after(new[None]), start(new[None]), atol=1e-9)
        np.testing.assert_allclose(after.controls[:3], start.controls, atol=1e-12)
        told = page.refused(session, "sites.place", {"layer": "Sites", "triangle": [5, 5, 5], "weights": [1, 0, 0]})
        assert "there is a site already" in told["message"]


def test_a_mirrored_site_stands_on_the_other_side_of_the_surface():
    with session_on(pl.Scene(ball()), "ball") as (session, page):
        placed(session, page, (0.6, -0.7, 0.3), mirror=0)
        sites = session.scene.stack["Sites"].deformer.sites
        np.testing.assert_allclose(sites[1], sites[0] * [-1, 1, 1], atol=0.01)
        placed(session, page, (0.1, 0.2, 1), "Sites")
        page.ask(session, "sites.mirror", {"layer": "Sites", "axis": 0})
        assert len(session.scene.stack["Sites"].deformer.sites) == 4
        assert "already" in page.refused(session, "sites.mirror", {"layer": "Sites", "axis": 0})["message"]


def test_sites_are_deleted_and_locks_stay_with_theirs():
    with session_on(pl.Scene(MESH), "egg") as (session, page):
        page.ask(session, "sites.scatter", {"count": 6})
        before = session.scene.stack["Sites"].deformer.sites
        page.ask(session, "points.lock", {"layer": "Sites", "locked": True}, index=np.array([3], np.uint32))
        told = page.refused(session, "sites.remove", {"layer": "Sites"}, index=np.array([3], np.uint32))
        assert "unlock" in told["message"]
        page.ask(session, "sites.remove", {"layer": "Sites"}, index=np.array([0, 2], np.uint32))
        np.testing.assert_array_equal(session.scene.stack["Sites"].deformer.sites, before[[1, 3, 4, 5]])
        assert session.locked_points("Sites").tolist() == [1]
        told = page.refused(session, "sites.remove", {"layer": "Sites"}, index=np.array([0, 2, 3], np.uint32))
        assert "two sites must be left" in told["message"]


def test_influence_is_how_the_points_move_with_the_selected_controls():
    for deformer in (pl.DirichletFFD(MESH.points[::600]), pl.BSplineFFD.around(MESH), pl.ExtendedFFD.cylinder(MESH)):
        scene = pl.Scene(MESH, pl.Stack([pl.Layer("Layer", deformer)]))
        with session_on(scene, "egg") as (session, page):
            chosen = np.array([1, 3], np.uint32)
            share = page.ask(session, "points.influence", {"layer": "Layer"}, index=chosen).arrays["values"]
            controls = np.array(deformer.controls)
            controls.reshape(-1, 3)[chosen] += [0.0, 0.0, 0.5]
            moved = deformer.moved(controls)(MESH.points) - MESH.points
            np.testing.assert_allclose(share, moved[:, 2] / 0.5, atol=1e-6)


@pytest.mark.parametrize(("kind", "shape"), [("cylinder", [8, 4, 7]), ("prism", [5, 4, 4]), ("sphere", [7, 4, 7])])
def test_a_round_lattice_is_the_library_s_and_survives_saving(kind, shape, tmp_path):
    with session_on(pl.Scene(MESH, selections={"top": np.flatnonzero(MESH.points[:, 2] > 0.4)}), "egg") as each:
        session, page = each
        asked = {"kind": kind, "axis": "z", "shape": shape, "margin": 0.1, "part": "top"}
        preview = page.ask(session, "extended.preview", asked)
        page.ask(session, "extended.add", asked)
        made = session.scene.stack[kind.capitalize()].deformer
        top = MESH.points[MESH.points[:, 2] > 0.4]
        of_kind = {
            "cylinder": lambda: pl.ExtendedFFD.cylinder(top, "z", tuple(shape), 0.1),
            "prism": lambda: pl.ExtendedFFD.prism(top, "z", shape[0], tuple(shape[1:]), 0.1),
            "sphere": lambda: pl.ExtendedFFD.sphere(top, "z", tuple(shape), 0.1),
        }[kind]()
        np.testing.assert_array_equal(made.rest, of_kind.rest)
        np.testing.assert_array_equal(preview.arrays["points"].reshape(-1, 3), made.rest)
        np.testing.assert_array_equal(links(made), made.links)
        page.ask(session, "points.set", {"layer": kind.capitalize()}, **_pushed(made))
        save_project(session.scene, tmp_path / "egg.pliant")
        again = load_project(tmp_path / "egg.pliant").deformed().points
        np.testing.assert_allclose(again, session.stage.binding.result, atol=1e-12)


def _pushed(lattice):
    return {"index": np.array([9], np.uint32), "positions": lattice.rest[9] + [0.2, 0.0, 0.1]}


def test_rings_of_a_round_lattice_are_circles():
    lattice = pl.ExtendedFFD.sphere(ball(), shape=(8, 4, 7))
    places = places_around(lattice)
    assert places_around(pl.BSplineFFD.around(MESH)) is None
    center = lattice.rest[(places == -1).sum(axis=1) == 2].mean(axis=0)
    ring = lattice.rest[(places[:, 1] == 2) & (places[:, 2] == 3)]
    assert len(ring) == 8
    assert np.ptp(ring[:, 2]) < 1e-9
    assert np.ptp(np.linalg.norm((ring - center)[:, :2], axis=1)) < 1e-9
    poles = lattice.rest[(places[:, 0] == -1) & (places[:, 1] == 3)]
    assert np.allclose(poles[:, :2], center[:2])


def test_requests_that_make_no_sense_are_refused():
    with session_on(pl.Scene(MESH), "egg") as (session, page):
        for values, word in (
            ({"kind": "cone", "axis": "z", "shape": [8, 4, 4]}, "cone"),
            ({"kind": "cylinder", "axis": "w", "shape": [8, 4, 4]}, "axis"),
            ({"kind": "cylinder", "axis": "z", "shape": [8, 5, 4]}, "4, 7, 10"),
            ({"kind": "cylinder", "axis": "z", "shape": [400, 40, 40]}, "more than"),
        ):
            assert word in page.refused(session, "extended.add", values)["message"]
        for values in (
            {"triangle": [0, 1, 10**9], "weights": THIRDS},
            {"triangle": [0, 1, 2], "weights": [1, 1, 1]},
            {"triangle": [0, 1, 2], "weights": [float("inf"), 0, 0]},
        ):
            assert page.refused(session, "sites.place", values)["kind"] == "InvalidParameter"
        assert "2 to" in page.refused(session, "sites.scatter", {"count": 1})["message"]


def test_a_placed_lattice_is_seen_where_it_stands():
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    frame = pl.Affine.of(2.0 * turn, [0.3, 0.0, -0.2])
    box, cylinder = pl.BSplineFFD.around(MESH, shape=(3, 3, 3)), pl.ExtendedFFD.cylinder(MESH)
    np.testing.assert_allclose(axes_of(pl.place(box, frame)), turn, atol=1e-12)
    np.testing.assert_array_equal(links(pl.place(cylinder, frame)), links(cylinder))
    np.testing.assert_array_equal(places_around(pl.place(cylinder, frame)), places_around(cylinder))
