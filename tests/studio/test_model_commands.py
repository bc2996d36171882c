"""Shape models in the studio without a browser: what is told is what the library computes."""

import time

import numpy as np
import pytest
from pages import joined

import pliant as pl
from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.shape.conditioned_model import ConditionedModel
from pliant.studio.commands.opening import main_file, read_scene
from pliant.studio.examples.samples import torus


def soft():
    full = torus(40, 18)
    ring = pl.PolygonMesh(full.points, full.faces)
    return pl.ShapeModel.from_kernel(ring, pl.GaussianKernel(sigma=1.0, scale=0.15), rank=15)


def model_scene():
    model = soft()
    return Scene(model.reference, Stack((Layer("Shape model", ConditionedModel(model)),)))


@pytest.fixture
def opened():
    yield from joined(model_scene(), "ring")


LAYER = {"layer": "Shape model"}


def shape_of(session):
    return session.scene.stack["Shape model"].deformer


def until(session, condition):
    end = time.monotonic() + 30
    while not session.submit(condition).result():
        assert time.monotonic() < end
        time.sleep(0.02)


def told(session, answer):
    """(n, 3) positions as a preview tells them."""
    low, high = (np.array(answer.head[end]) for end in ("low", "high"))
    return low + answer.arrays["positions"].reshape(-1, 3) / 65535 * (high - low)


def test_sliders_move_the_shape_as_the_model_does(opened):
    session, page = opened
    model = shape_of(session).model
    coefficients = np.random.default_rng(0).standard_normal(model.count)
    page.ask(session, "model.begin", LAYER)
    answer = page.ask(session, "model.move", coefficients=coefficients)
    np.testing.assert_allclose(told(session, answer), model.instance(coefficients), atol=1e-4)
    assert session.history.position == 0
    page.ask(session, "model.commit")
    assert session.history.position == 1
    np.testing.assert_allclose(session.scene.deformed().points, model.instance(coefficients), atol=1e-12)


def test_a_dragged_landmark_is_followed_by_the_mean_of_the_posterior(opened):
    session, page = opened
    model = shape_of(session).model
    for vertex in (5, 300):
        page.ask(session, "model.landmark", {**LAYER, "vertex": vertex})
    np.testing.assert_allclose(session.scene.deformed().points, model.mean, atol=1e-9)
    goals = model.mean[[5, 300]] + [[0.0, 0.0, 0.2], [0.1, 0.0, 0.0]]
    page.ask(session, "model.begin", LAYER)
    page.ask(session, "model.move", index=np.array([0], np.uint32), positions=goals[0])
    answer = page.ask(session, "model.move", index=np.array([1], np.uint32), positions=goals[1])
    known = model.posterior([5, 300], goals, noise=shape_of(session).noise)
    np.testing.assert_allclose(told(session, answer), known.mean, atol=1e-4)
    page.ask(session, "model.commit")
    np.testing.assert_allclose(session.scene.deformed().points, known.mean, atol=1e-12)
    uncertainty = page.ask(session, "model.uncertainty", LAYER)
    np.testing.assert_allclose(uncertainty.arrays["values"], known.uncertainty, atol=1e-6)
    assert uncertainty.head["high"] == pytest.approx(model.uncertainty.max())


def test_what_is_edited_is_saved_and_undone(opened, tmp_path):
    session, page = opened
    page.ask(session, "model.sample", {**LAYER, "seed": 7})
    expected = soft().instance(np.random.default_rng(7).standard_normal(45))
    np.testing.assert_allclose(session.scene.deformed().points, expected, atol=1e-12)
    page.ask(session, "model.landmark", {**LAYER, "vertex": 11})
    page.ask(session, "model.noise", {**LAYER, "noise": 0.05})
    np.testing.assert_allclose(session.scene.deformed().points, expected, atol=1e-9)
    saved = page.ask(session, "project.save")
    (tmp_path / "again.pliant").write_bytes(saved.arrays["file"].tobytes())
    again = read_scene(tmp_path / "again.pliant")
    np.testing.assert_array_equal(again.deformed().points, session.scene.deformed().points)
    assert again.stack["Shape model"].deformer.noise == 0.05
    page.ask(session, "model.release", LAYER, index=np.array([0], np.uint32))
    assert not len(shape_of(session).vertices)
    for _ in range(4):
        page.ask(session, "history.undo")
    np.testing.assert_allclose(session.scene.deformed().points, soft().mean, atol=1e-12)


def test_a_model_is_built_on_the_shape_from_a_kernel(opened):
    session, page = opened
    kernel = "gaussian(sigma=0.8, scale=0.1) + bspline(support=0.5, scale=0.02)"
    page.ask(session, "model.build", {"kernel": kernel, "rank": 20})
    until(session, lambda: len(session.scene.stack) == 2)
    found = session.scene.stack["Shape model 2"].deformer.model
    with_b_splines = pl.GaussianKernel(sigma=0.8, scale=0.1) + pl.BSplineKernel(support=0.5, scale=0.02)
    expected = pl.ShapeModel.from_kernel(session.scene.mesh, with_b_splines, rank=20)
    np.testing.assert_allclose(found.variances, expected.variances)
    page.ask(session, "model.build", {"kernel": "gaussian(", "rank": 20})
    until(session, lambda: page.events("failure"))
    assert "is no kernel" in page.events("failure")[-1].head["message"]


def test_a_fit_is_the_library_s_and_shows_its_rounds(opened, tmp_path):
    session, page = opened
    model = shape_of(session).model
    target = model.mesh(0.7 * np.random.default_rng(3).standard_normal(model.count))
    upload = sent(session, page, target, tmp_path)
    drawn = page.ask(session, "model.target", {"upload": upload})
    np.testing.assert_allclose(drawn.arrays["positions"].reshape(-1, 3), target.points, atol=1e-5)
    page.ask(session, "model.fit", {**LAYER, "rounds": 30})
    until(session, lambda: session.history.position == 1)
    expected = model.fit(pl.read(tmp_path / "target.ply"), iterations=30)
    np.testing.assert_allclose(session.scene.deformed().points, expected.points, atol=1e-9)
    assert session.scene.stack.names == ("Shape model",)
    parts = [event.head["part"] for event in page.events("progress") if event.head["part"] is not None]
    assert parts == sorted(parts)
    assert len(parts) == expected.iterations
    assert len(page.events("points")) > 3  # rounds are seen


def test_a_fit_that_moves_leaves_its_pose_in_a_layer(opened, tmp_path):
    session, page = opened
    model = shape_of(session).model
    bent = model.mesh(0.4 * np.random.default_rng(5).standard_normal(model.count))
    away = pl.compose(pl.Affine.rotation("z", 0.1), pl.Affine.translation([0.5, 0, 0.2]))
    upload = sent(session, page, away(bent), tmp_path)
    page.ask(session, "model.target", {"upload": upload})
    page.ask(session, "model.fit", {**LAYER, "pose": "rigid", "rounds": 25})
    until(session, lambda: session.history.position == 1)
    assert session.scene.stack.names == ("Shape model", "Pose of Shape model")
    expected = model.fit(pl.read(tmp_path / "target.ply"), iterations=25, pose="rigid")
    np.testing.assert_allclose(session.scene.deformed().points, expected.points, atol=1e-9)


def test_landmarks_are_seen_and_dragged_through_the_layers_above(opened):
    session, page = opened
    bend = pl.Twist.around(session.scene.mesh, axis="z", angle=0.6)
    stack = session.scene.stack.append(Layer("twist", bend))
    session.submit(session.commit, session.scene.replace(stack=stack), "add").result()
    page.ask(session, "model.landmark", {**LAYER, "vertex": 8})
    seen = page.ask(session, "model.get", LAYER).arrays["positions"]
    np.testing.assert_allclose(seen, session.scene.deformed().points[8], atol=1e-9)
    goal = seen + [0.0, 0.05, 0.1]
    page.ask(session, "model.begin", LAYER)
    page.ask(session, "model.move", index=np.array([0], np.uint32), positions=goal)
    page.ask(session, "model.commit")
    np.testing.assert_allclose(session.scene.deformed().points[8], goal, atol=2e-3)  # but for the noise
    np.testing.assert_allclose(page.ask(session, "model.get", LAYER).arrays["positions"], goal, atol=1e-6)


def test_a_fit_that_is_stopped_leaves_the_shape_as_it_was(opened, tmp_path):
    session, page = opened
    target = shape_of(session).model.mesh(np.ones(45))
    page.ask(session, "model.target", {"upload": sent(session, page, target, tmp_path)})
    page.ask(session, "model.fit", {**LAYER, "rounds": 500})
    until(session, lambda: len(page.events("points")) > 2)
    job = page.events("progress")[-1].head["job"]
    session.submit(page.ask, session, "job.cancel", {"job": job}).result()
    until(session, lambda: not session.jobs._running)
    session.jobs.end()  # the round under way
    session.submit(lambda: None).result()
    assert session.history.position == 0
    last = page.events("points")[-1]
    assert last.head["all"]
    np.testing.assert_allclose(last.arrays["positions"].reshape(-1, 3), soft().mean, atol=1e-6)
    assert not page.events("failure")


def test_a_fit_that_cannot_be_says_why(opened, tmp_path):
    session, page = opened
    mesh = session.scene.mesh
    inside_out = pl.PolygonMesh(mesh.points, mesh.triangles[:, ::-1])
    page.ask(session, "model.target", {"upload": sent(session, page, inside_out, tmp_path)})
    page.ask(session, "model.fit", LAYER)
    until(session, lambda: page.events("failure"))
    assert "turn normals that point inwards" in page.events("failure")[-1].head["message"]
    assert session.history.position == 0


def test_arrows_are_a_draw_from_the_process(opened):
    session, page = opened
    answer = page.ask(session, "model.field", {"sigma": 0.7, "scale": 0.2, "seed": 4, "count": 90})
    places = answer.arrays["positions"].reshape(-1, 3)
    kernel = pl.GaussianKernel(sigma=0.7, scale=0.2)
    expected = pl.GaussianProcess(kernel).draw(places.astype(np.float64), seed=4)
    near = np.abs(answer.arrays["vectors"].reshape(-1, 3) - expected).max()
    assert near < 0.05 * np.abs(expected).max()  # positions travel in 32 bits
    distances = np.linalg.norm(places[:, None] - places, axis=-1) + 9 * np.eye(90)
    assert distances.min() > 0.1  # spread


def test_model_files_are_opened_as_scenes(tmp_path):
    model = soft()
    for name in ("model.h5", "model.h5.json"):
        pl.write_model(model, tmp_path / name)
        (tmp_path / "notes.txt").write_text("nothing")
        assert main_file([tmp_path / "notes.txt", tmp_path / name]).name == name
        scene = read_scene(tmp_path / name)
        moved = scene.stack["Shape model"].deformer.moved(np.full(model.count, 0.5))(scene.mesh)
        np.testing.assert_allclose(moved.points, model.instance(np.full(model.count, 0.5)), atol=1e-5)


def test_what_makes_no_sense_is_refused_by_name(opened):
    session, page = opened
    refused = [
        ("model.begin", {"layer": "nothing"}, {}, "nothing"),
        ("model.landmark", {**LAYER, "vertex": 9999}, {}, "no vertex 9999"),
        ("model.coefficients", LAYER, {"coefficients": np.zeros(3)}, "shape"),
        ("model.fit", {**LAYER, "pose": "bent"}, {}, "'bent'"),
        ("model.fit", {**LAYER, "rounds": 0}, {}, "asked for 0"),
        ("model.fit", LAYER, {}, "load one first"),
        ("model.build", {"kernel": "gaussian(sigma=1, scale=1)", "rank": 5, "method": "luck"}, {}, "'luck'"),
        ("model.field", {"sigma": 0.0, "scale": 1.0}, {}, "sigma"),
        ("model.noise", {**LAYER, "noise": -1.0}, {}, "noise"),
    ]
    for command, values, arrays, words in refused:
        assert words in page.refused(session, command, values, **arrays)["message"], command
    page.ask(session, "model.begin", LAYER)
    assert "3 came" in page.refused(session, "model.move", {}, coefficients=np.zeros(3))["message"]


def sent(session, page, mesh, folder):
    """A mesh, uploaded."""
    pl.write(mesh, folder / "target.ply")
    data = (folder / "target.ply").read_bytes()
    upload = page.ask(session, "upload.begin", {"files": [{"name": "target.ply", "size": len(data)}]}).head["upload"]
    page.ask(session, "upload.chunk", {"upload": upload, "file": 0}, bytes=np.frombuffer(data, np.uint8))
    return upload
