"""Shape models by hand in a real browser, against what the library computes."""

import numpy as np
import pytest

import pliant as pl
from pliant.rendering.palette import SEQUENTIAL, color_table
from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.shape.conditioned_model import ConditionedModel
from pliant.studio.examples.samples import egg

LAYER = "Shape model"


def head():
    full = egg(48, 32)
    return pl.PolygonMesh(full.points, full.faces)


def model_scene():
    mesh = head()
    kernel = pl.GaussianKernel(sigma=0.4 * mesh.diagonal, scale=0.05 * mesh.diagonal)
    return Scene(mesh, Stack((Layer(LAYER, ConditionedModel(pl.ShapeModel.from_kernel(mesh, kernel, rank=20))),)))


@pytest.fixture
def models(launched, view):
    """A page in the mode of shape models, on a scene."""

    def open_page(scene):
        page = view(launched(scene))
        page.drawn()
        page.ask("window.pliantStudio.mode('model')")
        return page

    return open_page


def ready(page):
    page.until("window.pliantStudio.probes.model.ready()")
    page.settled()


def shape_of(page):
    return page.session.scene.stack[LAYER].deformer


def same_points(page, expected, tolerance=2e-6):
    diagonal = page.session.scene.mesh.diagonal
    np.testing.assert_allclose(page.positions(len(expected)), expected, atol=tolerance * diagonal)


def test_a_landmark_is_placed_by_a_click_and_the_posterior_follows_its_drag(models):
    page = models(model_scene())
    ready(page)
    model, revision = shape_of(page).model, page.session.revision
    page.ask("window.pliantStudio.look(0.3, -1, 0.2)")
    page.settled()
    front = int(np.argmin(model.mean[:, 1] - 0.3 * model.mean[:, 2]))
    at = page.ask(f"window.pliantStudio.vertex({front})")
    page.page.mouse.click(at["x"], at["y"])
    page.committed(revision)
    ready(page)
    assert page.ask("window.pliantStudio.probes.model.landmarks()") == shape_of(page).vertices.tolist()
    same_points(page, model.mean)  # a landmark where it is moves nothing
    start = page.ask("window.pliantStudio.probes.model.screen(0)")
    revision = page.session.revision
    page.drag((start["x"], start["y"]), (60, -45), steps=6, release=False)
    page.until("window.pliantStudio.latencies.length > 3")
    during = page.positions(len(model.mean))
    assert page.session.revision == revision  # previews are no history
    page.page.mouse.up()
    page.committed(revision)
    ready(page)
    shape = shape_of(page)
    known = model.posterior(shape.vertices, shape.positions, noise=shape.noise)
    same_points(page, known.mean)
    assert np.linalg.norm(during - model.mean, axis=1).max() > 0.05
    after = page.ask("window.pliantStudio.probes.model.screen(0)")
    assert abs(after["x"] - start["x"] - 60) < 2
    assert abs(after["y"] - start["y"] + 45) < 2
    colours_are_the_uncertainty(page, known)
    page.picture("model-posterior")


def colours_are_the_uncertainty(page, known):
    page.until("window.pliantStudio.probes.model.painted() && !document.querySelector('.legend').hidden")
    page.settled()
    table, most = 255 * color_table(SEQUENTIAL), shape_of(page).model.uncertainty.max()
    facing = known.reference.with_points(known.mean).vertex_normals @ np.array([0.28, -0.94, 0.19])
    far = int(np.argmax(np.where(facing > 0.93, known.uncertainty, -1)))
    at = page.ask(f"window.pliantStudio.vertex({far})")
    expected = table[round(255 * min(known.uncertainty[far] / most, 1))]
    assert np.abs(page.pixels(at["x"], at["y"])[0, 0] - expected).max() < 25


def test_sliders_samples_and_the_way_back(models):
    page = models(model_scene())
    ready(page)
    model, revision = shape_of(page).model, page.session.revision
    page.page.get_by_label("Coefficient 1 z", exact=True).fill("2.5")
    page.page.keyboard.press("Enter")
    page.committed(revision)
    one = np.zeros(model.count)
    one[2] = 2.5
    same_points(page, model.instance(one))
    track = page.page.get_by_label("Coefficient 2 x –", exact=True).bounding_box()
    page.drag((track["x"] + track["width"] / 2, track["y"] + 10), (track["width"] / 4, 0))
    page.committed(revision + 1)
    chosen = np.asarray(shape_of(page).coefficients)
    assert 1.2 < chosen[3] < 1.8  # a quarter of the six standard deviations
    same_points(page, model.instance(chosen))
    ready(page)
    page.page.get_by_role("button", name="Random sample").click()
    page.committed(revision + 2)
    assert np.abs(np.asarray(shape_of(page).coefficients)).min() > 0
    ready(page)
    same_points(page, shape_of(page).points)
    page.picture("model-sample")
    page.page.locator(".model-panel").get_by_role("button", name="Reset").click()
    page.committed(revision + 3)
    same_points(page, model.mean)


def test_a_model_is_built_in_a_dialog_and_arrows_show_its_field(models):
    page = models(Scene(head()))
    page.settled()
    page.page.get_by_label("Show arrows").check()
    page.until("window.pliantStudio.frames > 2")
    page.page.get_by_role("button", name="Build from a kernel").click()
    page.page.get_by_label("Fields").fill("12")
    page.page.get_by_label("As text").fill("gaussian(sigma=1, scale=0.2) + bspline(support=0.6, scale=0.02)")
    page.page.get_by_label("As text").click()
    revision = page.session.revision
    page.picture("model-dialog")
    page.page.get_by_role("button", name="Build", exact=True).click()
    page.committed(revision)
    ready(page)
    kernel = pl.GaussianKernel(sigma=1, scale=0.2) + pl.BSplineKernel(support=0.6, scale=0.02)
    expected = pl.ShapeModel.from_kernel(page.session.scene.mesh, kernel, rank=12)
    np.testing.assert_allclose(shape_of(page).model.variances, expected.variances)
    page.settled()
    page.picture("model-arrows")


def test_a_fit_shows_its_target_and_ends_where_the_library_does(models, tmp_path):
    scene = model_scene()
    model = scene.stack[LAYER].deformer.model
    pl.write(model.mesh(np.random.default_rng(2).standard_normal(model.count)), tmp_path / "other.ply")
    page = models(scene)
    ready(page)
    with page.page.expect_file_chooser() as choosing:
        page.page.get_by_role("button", name="Load a target").click()
    choosing.value.set_files(tmp_path / "other.ply")
    page.until("window.pliantStudio.probes.model.target()")
    page.settled()
    page.picture("model-target")
    target = pl.read(tmp_path / "other.ply")
    outside = int(np.argmax(np.linalg.norm(target.points - model.mean, axis=1)))
    orange_over_it(page, target, outside)
    revision = page.session.revision
    page.page.locator(".fit-target .button.primary").click()
    page.committed(revision)
    ready(page)
    same_points(page, model.fit(target).points)
    page.picture("model-fitted")


def orange_over_it(page, target, vertex):
    """Where only the target is, it is seen, translucent."""
    place = target.points[vertex]
    direction = np.cross(target.vertex_normals[vertex], [0.0, 0.0, 1.0])
    page.ask(f"window.pliantStudio.look({direction[0]}, {direction[1]}, {direction[2]})")
    page.settled()
    inner = place - 0.01 * target.vertex_normals[vertex]
    colors = []
    for point in (place, inner):
        at = page.ask(f"window.pliantStudio.probes.model.project({point.tolist()})")
        colors.append(page.pixels(at["x"] - 2, at["y"] - 2, 5, 5).reshape(-1, 3).astype(int))
    red, _, blue = np.concatenate(colors).T
    assert (red - blue).max() > 15
