"""Sites and round lattices by hand in a real browser, against what the library computes."""

import numpy as np
from test_in_the_browser import same_points

import pliant as pl
from pliant.rendering.palette import SEQUENTIAL, color_table
from pliant.studio.examples.samples import egg


def test_sites_are_clicked_onto_the_surface_dragged_and_deleted(launched, view):
    page = view(launched(pl.Scene(egg())))
    page.drawn()
    page.ask("window.pliantStudio.mode('sites')")
    page.ask("window.pliantStudio.look(0.3, -1, 0.3)")
    page.settled()
    revision = page.session.revision
    for at in ((330, 300), (330, 420), (420, 300), (400, 400)):
        page.page.mouse.click(*at)
    page.until("window.pliantStudio.probes.sites.count() === 4")
    page.committed(revision + 2)
    sites = page.session.scene.stack["Sites"].deformer
    assert len(sites.sites) == 4
    assert page.ask("window.pliantStudio.probes.sites.selected()") == [3]
    place = page.ask("window.pliantStudio.probes.sites.screen(3)")
    assert np.hypot(place["x"] - 400, place["y"] - 400) < 1
    page.until("!document.querySelector('.legend').hidden")
    page.settled()
    page.picture("sites-influence")
    mesh = page.session.scene.mesh
    share = sites.moved(sites.rest + np.eye(4)[3][:, None])(mesh.points)[:, 0] - mesh.points[:, 0]
    low = mesh.points[:, 1].max() - 2 * np.ptp(mesh.points[:, 1])  # seen from the front only
    most = int(np.argmin(np.where(mesh.points[:, 1] < 0, share, low + 10)))
    at = page.ask(f"window.pliantStudio.vertex({most})")
    assert share[most] < 0.02
    expected = 255 * color_table(SEQUENTIAL)[0]
    found = page.pixels(at["x"], at["y"])[0, 0]
    assert (found <= expected + 8).all()  # shaded at the rim, never lighter
    revision = page.session.revision
    page.drag((place["x"], place["y"]), (50, -40), steps=6)
    page.committed(revision)
    moves = page.session.scene.stack["Sites"].deformer.controls - sites.sites
    assert np.flatnonzero(np.linalg.norm(moves, axis=1)).tolist() == [3]
    same_points(page)
    page.page.keyboard.press("Delete")
    page.committed(revision + 1)
    assert len(page.session.scene.stack["Sites"].deformer.sites) == 3
    same_points(page)


def test_a_ring_of_a_cylinder_is_taken_by_a_click_and_dragged(launched, view):
    page = view(launched(pl.Scene(egg())))
    page.drawn()
    page.page.get_by_role("button", name="Add a deformer").click()
    page.page.get_by_placeholder("Search deformers").fill("extended")
    page.page.keyboard.press("Enter")
    page.page.get_by_role("dialog", name="New round lattice").wait_for()
    page.page.get_by_text("100 control points").wait_for()
    page.picture("round-lattice-dialog")
    revision = page.session.revision
    page.page.get_by_role("button", name="Create").click()
    page.committed(revision)
    page.handles()
    page.page.get_by_label("A click takes").select_option("ring")
    index = page.session.scene.stack["Cylinder"].deformer.blocks[0].index
    ring = sorted(index[:, 3, 1].tolist())
    page.drag(page.control(int(index[6, 3, 1])), (0, -40), steps=6)
    page.committed(revision + 1)
    assert page.ask("window.pliantStudio.selection()") == ring
    lattice = page.session.scene.stack["Cylinder"].deformer
    moves = lattice.controls - lattice.rest
    assert np.flatnonzero(np.linalg.norm(moves, axis=1)).tolist() == ring
    np.testing.assert_allclose(moves[ring], np.tile(moves[ring[0]], (8, 1)), atol=1e-9)
    same_points(page)
    page.picture("ring-dragged")
