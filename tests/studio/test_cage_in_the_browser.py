"""Cages by hand in a real browser, against what the library computes."""

import time
from dataclasses import replace

import numpy as np
from test_in_the_browser import same_points

import pliant as pl
from pliant.rendering.palette import SEQUENTIAL, color_table
from pliant.studio.examples.samples import bar, egg


def entered(page, direction):
    page.drawn()
    page.ask("window.pliantStudio.mode('cage')")
    page.ask(f"window.pliantStudio.look({direction})")
    page.settled()


def corner(page, index):
    at = page.ask(f"window.pliantStudio.probes.cage.screen({index})")
    return np.array([at["x"], at["y"]])


def test_a_cage_is_built_verified_dragged_by_a_face_and_its_coordinates_are_compared(launched, view):
    page = view(launched(pl.Scene(egg())))
    entered(page, "0.4, -1, 0.5")
    page.page.get_by_role("radio", name="Box").click()
    page.page.get_by_label("Vertices, at most").fill("20")
    revision = page.session.revision
    page.page.get_by_role("button", name="Build the cage").click()
    page.committed(revision)
    page.until("document.querySelectorAll('.cage-report .good').length === 3")
    page.settled()
    cage = page.session.scene.stack["Cage"].deformer
    page.page.get_by_label("A click takes").select_option("face")
    top = cage.mesh.points[:, 2].max()
    above = next(face for face in cage.mesh.faces if (cage.mesh.points[face, 2] == top).all())
    middle = np.mean([corner(page, int(index)) for index in above], axis=0)
    page.drag(middle, (30, -50), steps=6)
    page.committed(revision + 1)
    assert page.ask("window.pliantStudio.probes.cage.selected()") == sorted(above.tolist())
    moved = page.session.scene.stack["Cage"].deformer
    moves = moved.controls - moved.rest
    assert np.flatnonzero(np.linalg.norm(moves, axis=1)).tolist() == sorted(above.tolist())
    after = np.mean([corner(page, int(index)) for index in above], axis=0)
    assert np.abs(after - middle - [30, -50]).max() < 6  # what is held stays under the pointer
    same_points(page)
    page.page.get_by_role("button", name="Compare coordinates").click()
    page.until("document.querySelectorAll('.cage-row').length === 4")
    page.page.get_by_role("button", name="Green").click()
    page.until("!document.querySelector('.legend').hidden")
    page.page.get_by_label("A click takes").select_option("point")
    page.settled()
    page.picture("cage-compared")
    green = replace(moved, coordinates="green")
    mesh = page.session.scene.mesh
    away = np.linalg.norm(green(mesh.points) - moved(mesh.points), axis=1)
    least = int(np.where(mesh.points[:, 1] < -0.5, away, np.inf).argmin())
    at = page.ask(f"window.pliantStudio.vertex({least})")
    expected = 255 * color_table(SEQUENTIAL)[round(255 * away[least] / away.max())]
    assert np.abs(page.pixels(at["x"], at["y"])[0, 0] - expected).max() < 90
    page.page.get_by_label("Coordinates", exact=True).select_option("green")
    page.committed(revision + 2)
    np.testing.assert_allclose(
        page.positions(len(mesh.points)), green(mesh.points), atol=4e-6 * page.session.scene.mesh.diagonal
    )


def test_other_coordinates_stand_beside_and_follow_the_drag(launched, view):
    mesh = egg(24, 14)
    cage = pl.Cage(pl.cage_from_box(mesh, (1, 1, 1)))
    page = view(launched(pl.Scene(mesh, pl.Stack([pl.Layer("Cage", cage)]))))
    entered(page, "0.4, -1, 0.5")
    page.until("document.querySelectorAll('.cage-report .good').length === 3")
    page.page.get_by_label("Side by side").select_option("green")
    page.until("document.querySelectorAll('.viewport.side').length === 1")
    page.page.get_by_label("And beside").select_option("harmonic")
    page.until("document.querySelectorAll('.viewport.side').length === 2")
    titles = page.ask("[...document.querySelectorAll('.side-title')].map((each) => each.textContent).sort()")
    assert titles == ["Green", "Harmonic", "Mean value"]
    page.settled()
    top = int(np.argmax(cage.rest @ [1, -1, 1]))
    page.page.get_by_label("A click takes").select_option("point")
    page.settled()
    before = corner(page, top)
    page.drag(before, (20, -40), steps=6, release=False)
    page.until("window.pliantStudio.latencies.length > 0")

    def drawn(kind):
        whole = (
            f"Array.from({{length: {len(mesh.points)}}}, (_, i) => window.pliantStudio.probes.cage.beside('{kind}', i))"
        )
        return np.array(page.ask(whole))

    def follows(moved):
        wanted = {kind: replace(moved, coordinates=kind)(mesh.points) for kind in ("green", "harmonic")}
        end = time.monotonic() + 15
        while max(np.abs(drawn(kind) - points).max() for kind, points in wanted.items()) > 1e-5 * mesh.diagonal:
            assert time.monotonic() < end, "the views beside do not follow"
            time.sleep(0.05)

    def held():
        found = page.session.submit(lambda: page.session.dragging.stack["Cage"].deformer).result()
        return cage.moved(found.controls)

    page.settled()
    assert np.linalg.norm(held().controls - cage.rest) > 0.1
    assert np.abs(corner(page, top) - before - [20, -40]).max() < 6  # no arrow of the gizmo has taken it
    follows(held())  # live, while the pointer holds on
    page.picture("cage-beside")
    page.page.mouse.up()
    page.committed(page.session.revision - 1)
    page.page.get_by_label("And beside").select_option("")
    page.until("document.querySelectorAll('.viewport.side').length === 1")
    page.ask("window.pliantStudio.mode('look')")
    page.until("document.querySelectorAll('.viewport.side, .side-title').length === 0")


def test_planes_are_drawn_across_a_bar_and_its_edges_are_dragged(launched, view):
    page = view(launched(pl.Scene(bar())))
    entered(page, "0, -1, 0.25")
    page.page.get_by_role("radio", name="Planes").click()
    places = []
    for number, x in enumerate((-1.4, 0.0, 1.4)):
        top = int(np.argmin(np.linalg.norm(bar().points - [x, -0.4, 0.4], axis=1)))
        at = page.ask(f"window.pliantStudio.vertex({top})")
        places.append(bar().points[top, 0])
        page.drag((at["x"], at["y"] - 40), (0, 180), steps=4)
        page.until(f"window.pliantStudio.probes.cage.cuts().length === {number + 1}")
    cuts = np.array(page.ask("window.pliantStudio.probes.cage.cuts()"))
    np.testing.assert_allclose(np.abs(cuts[:, 3]), 1.0, atol=0.02)  # a little tilted by the perspective
    np.testing.assert_allclose(cuts[:, 0], places, atol=0.1)
    page.settled()
    page.picture("cage-planes")
    revision = page.session.revision
    page.page.get_by_role("button", name="Build the cage").click()
    page.committed(revision)
    builder = pl.CageBuilder(page.session.scene.mesh, 6, 0.03)
    for cut in cuts:
        builder = builder.cut(cut[:3], cut[3:])
    cage = page.session.scene.stack["Cage"].deformer
    np.testing.assert_allclose(cage.rest, builder.build(vertices=120).points, atol=1e-9)
    page.until("document.querySelectorAll('.cage-report .good').length === 3")
    page.page.get_by_label("A click takes").select_option("edge")
    page.settled()
    links = cage.links
    top = links[np.argmax(cage.rest[links][:, :, 2].sum(axis=1) - 2 * cage.rest[links][:, :, 1].sum(axis=1))]
    middle = np.mean([corner(page, int(index)) for index in top], axis=0)
    page.drag(middle, (0, -50), steps=6)
    page.committed(revision + 1)
    assert page.ask("window.pliantStudio.probes.cage.selected()") == sorted(top.tolist())
    same_points(page)
    page.picture("cage-edge")
