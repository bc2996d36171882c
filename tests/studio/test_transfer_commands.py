"""Deformation transfer without a browser: markers, computing and playing agree with the library's transfer."""

import json

import numpy as np
import pytest
from pages import joined

import pliant as pl
from pliant.io import meshes
from pliant.scene.scene import Scene
from pliant.studio.examples.samples import bar
from pliant.studio.examples.transfer_sample import arm, posed_bar
from pliant.studio.modes.transferring import read_markers

ARM = arm()
BENCH = posed_bar(ARM)
POSES = BENCH.poses


@pytest.fixture(scope="module")
def clone():
    return pl.DeformationTransfer(BENCH.source, ARM, np.array(BENCH.markers))


@pytest.fixture
def edited():
    yield from joined(Scene(ARM), "arm")


def sent(page, session, paths):
    """The name of an upload of files."""
    files = [{"name": path.name, "size": path.stat().st_size} for path in paths]
    name = page.ask(session, "upload.begin", {"files": files}).head["upload"]
    for at, path in enumerate(paths):
        data = np.frombuffer(path.read_bytes(), np.uint8)
        page.ask(session, "upload.chunk", {"upload": name, "file": at}, bytes=data)
    return name


def written(folder, names=("bar-02", "bar-reference")):
    """The source at rest and in poses, as files."""
    paths = []
    for name, points in zip(names, [POSES["bent"], BENCH.source.points], strict=False):
        paths.append(folder / f"{name}.obj")
        meshes.write(BENCH.source.with_points(points), paths[-1])
    return paths


def computed(page, session):
    page.ask(session, "transfer.compute")
    session.jobs._pool.submit(lambda: None).result()
    session.submit(lambda: None).result()


def test_files_markers_and_computing_give_what_the_library_does(edited, clone, tmp_path):
    session, page = edited
    page.ask(session, "transfer.source", {"upload": sent(page, session, written(tmp_path))})
    told = page.events("transfer")[-1].head["state"]
    assert (told["name"], told["poses"], told["markers"]) == ("bar-reference", ["bar-02"], [])
    for one, two in BENCH.markers:
        page.ask(session, "transfer.mark", {"source": one, "target": two})
    computed(page, session)
    parts = [frame.head["part"] for frame in page.events("progress") if frame.head["part"] is not None]
    assert parts == sorted(parts)
    assert parts[-1] == 1.0
    layer = session.scene.stack[page.events("transfer")[-1].head["state"]["layer"]]
    assert list(layer.deformer.names) == ["bar-02"]
    np.testing.assert_allclose(session.scene.deformed().points, clone.points(POSES["bent"]), atol=1e-6)
    page.ask(session, "history.undo")
    assert not len(session.scene.stack)


def test_poses_are_played_saved_and_exported(edited, clone, tmp_path):
    session, page = edited
    page.ask(session, "transfer.example")
    computed(page, session)
    (layer,) = session.scene.stack.names
    count = len(session.history.entries)
    weights = [0.25, 0.75, 0.0]
    page.ask(session, "transfer.begin", {"layer": layer})
    answer = page.ask(session, "transfer.move", {"weights": weights})
    mixed = BENCH.source.points + sum(
        weight * (points - BENCH.source.points) for weight, points in zip(weights, POSES.values(), strict=True)
    )
    np.testing.assert_allclose(answer.arrays["source"].reshape(-1, 3), mixed, atol=1e-6)
    page.ask(session, "transfer.commit")
    assert len(session.history.entries) == count + 1
    expected = ARM.points + sum(
        weight * (clone.points(points) - ARM.points) for weight, points in zip(weights, POSES.values(), strict=True)
    )
    np.testing.assert_allclose(session.shown.binding.result, expected, atol=1e-9)
    assert page.ask(session, "transfer.keys", {"layer": layer}).head["weights"] == weights
    (tmp_path / "arm.pliant").write_bytes(page.ask(session, "project.save").arrays["file"].tobytes())
    np.testing.assert_allclose(pl.load_project(tmp_path / "arm.pliant").deformed().points, expected, atol=1e-9)
    files = page.ask(session, "transfer.export", {"suffix": ".ply", "layer": layer}).arrays
    assert list(files) == ["Arm-1-bent.ply", "Arm-2-twisted.ply", "Arm-3-thin.ply"]
    (tmp_path / "twisted.ply").write_bytes(files["Arm-2-twisted.ply"].tobytes())
    np.testing.assert_allclose(meshes.read(tmp_path / "twisted.ply").points, clone.points(POSES["twisted"]), atol=1e-5)


def test_more_poses_are_transferred_without_finding_the_correspondence_again(edited, tmp_path):
    session, page = edited
    page.ask(session, "transfer.example")
    for name in ("twisted", "thin"):
        page.ask(session, "transfer.drop_pose", {"name": name})
    computed(page, session)
    known = session.beside["transfer"].clone
    meshes.write(BENCH.source.with_points(POSES["thin"]), tmp_path / "thin.obj")
    page.ask(session, "transfer.poses", {"upload": sent(page, session, [tmp_path / "thin.obj"])})
    computed(page, session)
    assert session.beside["transfer"].clone is known
    (layer,) = session.scene.stack
    assert list(layer.deformer.names) == ["bent", "thin"]
    page.ask(session, "transfer.unmark", {"index": 0})
    assert session.beside["transfer"].clone is None


def test_a_project_is_a_source_whose_clip_is_played(edited, tmp_path):
    session, page = edited
    twist = pl.Twist(axis="x", angle=1.0, bounds=(-1.6, 1.6))
    stack = pl.Stack([pl.Layer("Twist", twist)])
    clip = pl.Clip(BENCH.source, stack).key("Twist", 0.0, {"angle": 0.0}).key("Twist", 1.0, {"angle": 2.0})
    pl.save_project(Scene(BENCH.source, stack, clip), tmp_path / "bar.pliant")
    page.ask(session, "transfer.source", {"upload": sent(page, session, [tmp_path / "bar.pliant"])})
    bench = session.beside["transfer"]
    *_, last = bench.poses.values()
    np.testing.assert_allclose(last, pl.Twist(axis="x", angle=2.0, bounds=(-1.6, 1.6))(BENCH.source).points, atol=1e-9)


def test_markers_are_read_as_they_are_written():
    pairs = np.array([[3, 4], [5, 6], [1, 9]])
    texts = (
        json.dumps({"markers": pairs.tolist()}),
        "\n".join(f"{a} {b}" for a, b in pairs),
        "3\n" + "\n".join(f"{a}, {b}" for a, b in pairs),
    )
    for text in texts:
        assert read_markers([text]).tolist() == pairs.tolist()
    assert read_markers(["3 5 1\n", "4 6 9"]).tolist() == pairs.tolist()


def test_markers_are_put_taken_away_and_loaded(edited):
    session, page = edited
    page.ask(session, "transfer.example")
    page.ask(session, "transfer.unmark")
    page.ask(session, "transfer.load", {"texts": ["1 2\n3 4\n5 6"]})
    page.ask(session, "transfer.unmark", {"index": 1})
    assert page.ask(session, "transfer.state").head["state"]["markers"] == [[1, 2], [5, 6]]
    refused = page.refused(session, "transfer.load", {"texts": ["1 2\n3 99999999"]})
    assert "target vertex 99999999" in refused["message"]
    assert page.ask(session, "transfer.state").head["state"]["markers"] == [[1, 2], [5, 6]]  # nothing is lost
    drawn = page.ask(session, "transfer.mesh", {"pose": "bent"}).arrays["positions"]
    np.testing.assert_allclose(drawn.reshape(-1, 3), POSES["bent"], atol=1e-6)


@pytest.mark.parametrize(
    ("command", "values", "cause"),
    [
        ("transfer.mesh", {}, "no source yet"),
        ("transfer.compute", {}, "no source yet"),
        ("transfer.source", {"upload": "gone"}, "send the files again"),
        ("transfer.begin", {"layer": "Nothing"}, "Nothing"),
    ],
)
def test_without_a_source_commands_say_so(edited, command, values, cause):
    session, page = edited
    assert cause in page.refused(session, command, values)["message"]


@pytest.mark.parametrize(
    ("command", "values", "cause"),
    [
        ("transfer.mark", {"source": 8, "target": 123456}, "target vertex 123456"),
        ("transfer.mark", {"source": 140, "target": 3}, "marked already"),
        ("transfer.unmark", {"index": 99}, "no marker 99"),
        ("transfer.drop_pose", {"name": "none"}, "no pose"),
        ("transfer.mesh", {"pose": "none"}, "no pose"),
        ("transfer.load", {"texts": ["one two"]}, "no markers"),
        ("transfer.load", {"texts": ["1 2 3 4 5"]}, "two a marker"),
        ("transfer.load", {"texts": ["1 2", "1"]}, "pairs"),
        ("transfer.load", {"texts": [7]}, "texts"),
    ],
)
def test_bad_requests_are_refused(edited, command, values, cause):
    session, page = edited
    page.ask(session, "transfer.example")
    assert cause in page.refused(session, command, values)["message"]


def test_a_pose_of_another_mesh_and_too_few_markers_are_refused(edited, tmp_path):
    session, page = edited
    page.ask(session, "transfer.example")
    meshes.write(bar(), tmp_path / "other.obj")
    name = sent(page, session, [tmp_path / "other.obj"])
    assert "other has" in page.refused(session, "transfer.poses", {"upload": name})["message"]
    page.ask(session, "transfer.load", {"texts": ["1 2\n3 4"]})
    assert "at least 3" in page.refused(session, "transfer.compute")["message"]
