"""Surface editing by mouse and keyboard, against what the library picks and computes itself."""

import numpy as np

import pliant as pl
from pliant.numerics.rigid.twists import twist_about
from pliant.scene.scene import Scene
from pliant.studio.examples.samples import bar
from pliant.surface import regions
from pliant.surface.screen import in_brush, in_lasso

PROBE = "window.pliantStudio.probes.surface"
BAR = bar()
TIP = 59 * 40 + 35  # a vertex on the side that is looked at, near the end


def opened(launched, view, from_=(0.2, -1, 0.35)):
    page = view(launched(Scene(BAR)))
    page.drawn()
    page.ask("window.pliantStudio.mode('surface')")
    page.ask(f"window.pliantStudio.look{from_}")
    page.settled()
    return page


def chosen(page, part):
    return np.array(page.ask(f"{PROBE}.indices('{part}')"), np.int64)


def place(page, vertex):
    """Where a vertex is on the page, in whole pixels: mice know no others."""
    at = page.ask(f"window.pliantStudio.vertex({vertex})")
    return round(at["x"]), round(at["y"])


def camera(page):
    return np.array(page.ask(f"{PROBE}.camera()")).reshape(4, 4).T


def screen(page, places):
    """Pixels of the page as coordinates of the screen."""
    box = page.page.locator(".viewport canvas").first.bounding_box()
    flat = (np.array(places, float) - [box["x"], box["y"]]) / [box["width"], box["height"]]
    return np.column_stack([2 * flat[:, 0] - 1, 1 - 2 * flat[:, 1]])


def stroke(page, places, keys=()):
    for key in keys:
        page.page.keyboard.down(key)
    page.page.mouse.move(*places[0])
    page.page.mouse.down()
    for each in places[1:]:
        page.page.mouse.move(*each)
    page.page.mouse.up()
    for key in keys:
        page.page.keyboard.up(key)


def picked(page, part, size):
    page.until(f"{PROBE}.count('{part}') {size}")
    page.settled()


def geodesic_handle(page):
    """Press on the tip, and drag out: a handle."""
    page.page.keyboard.press("h")
    page.page.keyboard.press("e")
    x, y = place(page, TIP)
    stroke(page, [(x, y), (x + 12, y), (x + 30, y)])
    picked(page, "handle", "> 0")


def test_a_region_a_handle_and_a_drag_by_three_methods(launched, view):
    page = opened(launched, view)
    page.page.locator("canvas").first.focus()
    page.page.keyboard.press("v")  # through
    corners = [(420, 130), (668, 470)]
    page.page.keyboard.press("b")
    stroke(page, corners)
    picked(page, "region", "> 0")
    outline = screen(page, [(420, 130), (668, 130), (668, 470), (420, 470)])
    region = chosen(page, "region")
    assert region.tolist() == in_lasso(BAR, camera(page), outline).tolist()
    geodesic_handle(page)
    handle = chosen(page, "handle")
    reach = regions.geodesic_distance(BAR.points, BAR.triangles, [TIP])
    assert reach[handle].max() < np.delete(reach, handle).min()  # a ball along the surface
    page.page.keyboard.press("g")
    page.settled()
    blue, red = (page.pixels(*place(page, vertex))[0, 0].astype(int) for vertex in (48 * 40 + 35, TIP - 3 * 40))
    assert blue[2] > blue[0] + 30
    assert red[0] > red[2] + 30
    page.picture("surface-region")

    revision = page.session.revision
    pivot = page.ask(f"{PROBE}.pivot()")
    page.drag((pivot["x"], pivot["y"]), (-20, -110), steps=6, release=False)  # the gizmo's middle: in the view's plane
    page.until("window.pliantStudio.latencies.length > 0")
    page.page.keyboard.press("m")
    page.until(f"{PROBE}.converged()")  # the pointer rests, and the iteration goes on
    energies = np.array(page.ask(f"{PROBE}.energies()"))
    assert (np.diff(energies) <= 1e-6 * energies[0]).all()
    page.picture("surface-arap")
    assert page.session.revision == revision
    page.page.mouse.up()
    page.committed(revision)
    made = page.session.scene.stack["Edit"].deformer
    assert isinstance(made, pl.ARAP)
    assert made.roi.tolist() == region.tolist()
    assert made.handle.tolist() == handle.tolist()
    shift = made.goal - BAR.points[handle]
    np.testing.assert_allclose(shift, np.broadcast_to(shift[0], shift.shape), atol=1e-12)  # moved, not turned
    expected = pl.ARAP(region, handle, goal=made.goal)(BAR).points
    np.testing.assert_allclose(page.positions(len(expected)), expected, atol=1e-5)
    after = place(page, TIP)
    page.page.get_by_role("radio", name="Laplacian").click()
    page.committed(revision + 1)
    expected = pl.LaplacianEdit(region, handle, goal=made.goal)(BAR).points
    np.testing.assert_allclose(page.positions(len(expected)), expected, atol=1e-5)
    np.testing.assert_allclose(place(page, TIP), after, atol=1)  # the handle stays
    assert page.ask(f"{PROBE}.own()") == "Edit"


def test_a_brush_paints_in_front_and_selections_get_names(launched, view):
    page = opened(launched, view)
    page.page.locator("canvas").first.focus()
    page.page.keyboard.press("d")
    places = [place(page, row * 40 + 35) for row in (20, 30, 40)]
    stroke(page, places)
    picked(page, "region", "> 0")
    box = page.page.locator(".viewport canvas").first.bounding_box()
    radius = (52 / box["width"], 52 / box["height"])
    front = in_brush(BAR, camera(page), screen(page, places), radius, visible=True)
    assert chosen(page, "region").tolist() == front.tolist()
    page.page.keyboard.press("l")
    around = [place(page, row * 40 + column) for row, column in ((27, 32), (33, 32), (33, 38), (27, 38))]
    stroke(page, around, ["Alt"])
    picked(page, "region", f"< {len(front)}")
    cut = in_lasso(BAR, camera(page), screen(page, around), visible=True)
    kept = np.setdiff1d(front, cut)
    assert chosen(page, "region").tolist() == kept.tolist()
    page.page.keyboard.press("+")
    picked(page, "region", f"> {len(kept)}")
    grown = regions.grow(BAR, kept)
    assert chosen(page, "region").tolist() == grown.tolist()
    revision = page.session.revision
    page.page.get_by_label("Name of the selection").fill("side")
    page.page.keyboard.press("Enter")
    page.committed(revision)
    assert page.session.scene.selections["side"].tolist() == grown.tolist()
    page.page.get_by_role("button", name="Clear").click()
    picked(page, "region", "=== 0")
    page.page.get_by_role("button", name="Take as the handle: side").click()
    picked(page, "handle", f"=== {len(grown)}")
    page.picture("surface-named")


def test_the_skeleton_beside_the_mesh_is_picked_and_follows(launched, view):
    page = opened(launched, view)
    page.page.get_by_role("radio", name="Beside").click()
    page.until(f"{PROBE}.nodes().length > 0")
    page.settled()
    skeleton = pl.contour_skeleton(BAR)
    np.testing.assert_allclose(np.array(page.ask(f"{PROBE}.nodes()")).reshape(-1, 3), skeleton.points, atol=1e-9)
    along = np.argsort(skeleton.points[:, 0])
    node = {name: page.ask(f"{PROBE}.node({along[at]})") for name, at in (("before", 17), ("after", 18), ("last", -1))}
    page.page.locator("canvas").first.focus()
    page.page.keyboard.press("b")
    start, end = (node["before"]["x"] + node["after"]["x"]) / 2, node["last"]["x"]
    stroke(page, [(start, 200), (end - 40, 400), (end + 30, 480)])
    picked(page, "region", "> 0")
    assert chosen(page, "region").tolist() == np.flatnonzero(np.isin(skeleton.groups, along[18:])).tolist()
    page.page.keyboard.press("h")
    page.page.mouse.click(node["last"]["x"], node["last"]["y"])
    picked(page, "handle", "> 0")
    assert chosen(page, "handle").tolist() == np.flatnonzero(skeleton.groups == along[-1]).tolist()
    page.page.get_by_role("radio", name="Skeleton").click()
    page.page.keyboard.press("g")
    page.settled()
    pivot = page.ask(f"{PROBE}.pivot()")
    revision = page.session.revision
    page.drag((pivot["x"], pivot["y"]), (0, -70), steps=6)  # the middle of the gizmo: in the plane of the view
    page.committed(revision)
    made = page.session.scene.stack["Edit"].deformer
    assert isinstance(made, pl.SkeletonEdit)
    assert np.linalg.norm(made.goal.mean(axis=0) - BAR.points[made.handle].mean(axis=0)) > 0.2
    now = made(BAR).points
    np.testing.assert_allclose(page.positions(len(now)), now, atol=1e-5)
    nodes = np.array(page.ask(f"{PROBE}.nodes()")).reshape(-1, 3)
    np.testing.assert_allclose(nodes, skeleton.following(now - BAR.points), atol=1e-9)
    page.picture("surface-skeleton")
    it_swings_about_its_joint(page, made, revision + 1)
    it_is_twisted_about_itself(page, revision + 2)
    vertex = place(page, 5 * 40 + 35)
    clay = page.pixels(*vertex)[0, 0].astype(int)
    page.page.get_by_label("Mesh", exact=True).click()
    page.settled()
    assert np.abs(page.pixels(*vertex)[0, 0].astype(int) - clay).max() > 40
    page.page.get_by_role("radio", name="Off").click()
    page.ask("window.pliantStudio.mode('look')")
    page.settled()
    assert np.abs(page.pixels(*place(page, 5 * 40 + 35))[0, 0].astype(int) - clay).max() < 40  # there again


def it_swings_about_its_joint(page, made, revision):
    """Turned by the gizmo, the handle goes around the region's fixed edge."""
    page.page.keyboard.press("r")
    page.settled()
    joint = page.ask(f"{PROBE}.joint()")
    page.drag((joint["x"] + 6, joint["y"] + 3), (0, -50), steps=6)  # inside the rings: about an axis across the drag
    page.committed(revision)
    after = page.session.scene.stack["Edit"].deformer
    edge = BAR.points[made.bind(BAR).constraints.belt].mean(axis=0)
    before, now = (each.goal.mean(axis=0) - edge for each in (made, after))
    np.testing.assert_allclose(np.linalg.norm(now), np.linalg.norm(before), rtol=1e-4)
    assert np.linalg.norm(now - before) > 0.1
    expected = after(BAR).points
    np.testing.assert_allclose(page.positions(len(expected)), expected, atol=1e-5)
    page.picture("surface-swung")


def it_is_twisted_about_itself(page, revision):
    """The blue ring lies around the limb: dragged, it turns the handle where it is."""
    before = page.session.scene.stack["Edit"].deformer
    page.page.keyboard.press("z")
    page.settled()
    ring = page.ask(f"{PROBE}.ring()")
    page.drag((ring["x"], ring["y"]), (30, 60), steps=6)
    page.committed(revision)
    after = page.session.scene.stack["Edit"].deformer
    middle = before.goal.mean(axis=0)
    np.testing.assert_allclose(after.goal.mean(axis=0), middle, atol=1e-6)
    limb = middle - BAR.points[after.bind(BAR).constraints.belt].mean(axis=0)
    angle, _ = twist_about(before.goal, after.goal, limb / np.linalg.norm(limb))
    assert abs(angle) > 0.1
    was, now = (np.linalg.norm(each.goal - middle, axis=1) for each in (before, after))
    np.testing.assert_allclose(now, was, atol=1e-6)
    expected = after(BAR).points
    np.testing.assert_allclose(page.positions(len(expected)), expected, atol=1e-5)
    page.picture("surface-twisted")
