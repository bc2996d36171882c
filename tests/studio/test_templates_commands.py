"""Templates and the export of clips, without a browser: previews, what is put on a scene, files and how they end."""

import io
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest
from pages import joined
from test_time_commands import bent_scene

import pliant as pl
import pliant.scene
from pliant.scene.scene import Scene
from pliant.studio.examples.samples import ball, torus, vase
from pliant.studio.seen.previews import Small, preview

OURS = sorted(path.stem for path in Path(pliant.scene.__file__).with_name("template_files").glob("*.toml"))


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("PLIANT_TEMPLATES", str(tmp_path / "templates"))


@pytest.fixture
def ring():
    yield from joined(Scene(torus(around=40, across=16)), "ring")


@pytest.fixture
def moving():
    yield from joined(bent_scene(), "bar")


def test_the_gallery_holds_every_template(ring):
    session, page = ring
    told = page.ask(session, "templates.list").head["templates"]
    assert [each["name"] for each in told] == list(pl.templates())
    assert len(told) == 34
    assert not any(each["own"] for each in told)


def test_a_small_mesh_is_the_large_one_with_few_vertices():
    mesh = vase()
    small = Small.of(mesh)
    assert len(small.mesh.points) == 1100
    np.testing.assert_array_equal(small.at(2 * mesh.points).points, 2 * mesh.points[small.kept])
    np.testing.assert_allclose(small.mesh.bounds, mesh.bounds, atol=0.02 * mesh.diagonal)


@pytest.mark.parametrize("name", OURS)
def test_a_preview_is_the_template_s_own_motion(name):
    egg = ball(around=12, along=8)
    recipe, mesh = pl.template(name), egg.with_points(egg.points * [0.4, 0.4, 1.5])
    found = preview(recipe, mesh, 1.0, "z")
    clip = recipe.clip(mesh)
    expected = [clip.sample(i * clip.period / 20).points for i in (0, 7, 13)]
    np.testing.assert_allclose(found.points[[0, 7, 13]], expected, atol=1e-5)


def test_a_template_takes_the_place_of_what_was(ring):
    session, page = ring
    page.ask(session, "layers.add", {"kind": "twist"})
    page.ask(session, "templates.apply", {"name": "wobble", "intensity": 0.5, "duration": 3.0, "replace": True})
    expected = pl.template("wobble").clip(session.scene.mesh, intensity=0.5, duration=3.0)
    for moment in (0.4, 1.7, 3.0):
        np.testing.assert_allclose(session.scene.clip.sample(moment).points, expected.sample(moment).points, atol=1e-12)
    page.ask(session, "templates.apply", {"name": "wobble", "replace": True})  # once more, while one is shown
    assert [len(track.keys) for track in session.scene.clip.tracks] == [8]
    page.ask(session, "history.undo")
    page.ask(session, "history.undo")
    assert session.scene.clip is None


def test_a_template_comes_on_top_from_the_playhead_on(moving):
    session, page = moving
    page.ask(session, "time.goto", {"time": 1.0})
    shape = session.scene.deformed()
    page.ask(session, "templates.apply", {"name": "wobble", "replace": False, "start": 1.0})
    page.ask(session, "templates.apply", {"name": "wobble", "replace": False, "start": 1.5})
    assert session.scene.stack.names == ("Bend", "wobble", "wobble 2")
    clip = session.scene.clip
    assert clip.duration == pytest.approx(3.3)
    assert [track.keys[0].time for track in clip.tracks] == [0.0, 1.0, 1.5]
    before = bent_scene().clip
    np.testing.assert_allclose(clip.sample(0.5).points, before.sample(0.5).points, atol=1e-12)
    twist = pl.template("wobble").clip(shape).stack_at(0.3)["wobble"].deformer
    only = Scene(session.scene.mesh, session.scene.stack.remove("wobble 2"), clip).clip
    np.testing.assert_allclose(only.sample(1.3).points, twist(before.sample(1.3)).points, atol=1e-12)


def test_a_template_that_does_not_move_is_layers_only(ring):
    session, page = ring
    mesh = session.scene.mesh
    twist = pl.Twist.around(mesh, axis="z", angle=1.0)
    pl.save_template(pl.Stack([pl.Layer("Twist", twist)]), "turned")
    page.ask(session, "templates.apply", {"name": "turned", "replace": False})
    assert session.scene.clip is None
    np.testing.assert_allclose(session.shown.told, twist(mesh).points, atol=1e-12)
    shown = page.ask(session, "templates.preview", {"name": "turned", "replace": True}).arrays["positions"]
    np.testing.assert_allclose(shown.reshape(20, -1, 3)[10], twist(mesh).points, atol=1e-6)  # there and back


def test_one_s_own_template_is_kept_and_offered(moving):
    session, page = moving
    page.ask(session, "templates.save", {"name": "my-bend", "title": "My bend", "about": "Bends."})
    told = {each["name"]: each for each in page.ask(session, "templates.list").head["templates"]}
    assert (told["my-bend"]["title"], told["my-bend"]["own"], told["my-bend"]["moves"]) == ("My bend", True, True)
    page.ask(session, "templates.apply", {"name": "my-bend", "replace": True})
    np.testing.assert_allclose(session.scene.clip.sample(1.2).points, bent_scene().clip.sample(1.2).points, atol=1e-9)
    assert page.refused(session, "templates.save", {"name": "../out"})["kind"] == "InvalidParameter"


@pytest.mark.parametrize(
    ("command", "values"),
    [
        ("templates.apply", {"name": "nothing", "replace": True}),
        ("templates.apply", {"name": "wobble", "replace": True, "intensity": 99.0}),
        ("templates.apply", {"name": "wobble", "replace": True, "duration": -1.0}),
        ("templates.preview", {"name": "wobble", "replace": True, "up": "x"}),
        ("templates.save", {"name": "of-nothing"}),
        ("export.clip", {"suffix": ".exe"}),
        ("export.clip", {"suffix": ".gif", "width": 100_000}),
    ],
)
def test_what_makes_no_sense_is_refused(ring, command, values):
    session, page = ring
    assert page.refused(session, command, values)["kind"] != "Bug"
    assert session.scene.clip is None


def exported(page, patience=30):
    end = time.monotonic() + patience
    while not page.events("exported"):
        assert time.monotonic() < end, page.events("failure")
        time.sleep(0.02)
    return page.events("exported")[-1]


def test_a_clip_is_exported_with_progress_and_says_what_is_lost(moving, tmp_path):
    session, page = moving
    page.ask(session, "export.clip", {"suffix": ".pc2"})
    answer = exported(page)
    (name,) = answer.head["files"]
    (tmp_path / name).write_bytes(answer.arrays[name].tobytes())
    motion = pl.read_sequence(tmp_path / name, mesh=session.scene.mesh)
    for at, moment in enumerate(bent_scene().clip.times):
        np.testing.assert_allclose(motion.points[at], bent_scene().clip.sample(moment).points, atol=1e-6)
    assert any("positions" in loss for loss in answer.head["losses"])
    parts = [frame.head["part"] for frame in page.events("progress") if frame.head["part"] is not None]
    assert parts == sorted(parts)
    assert parts[-1] == 1.0


def test_several_files_come_as_one_archive(moving):
    session, page = moving
    page.ask(session, "export.clip", {"suffix": ".pvd"})
    answer = exported(page)
    assert answer.head["files"] == ["bar.pvd.zip"]
    names = zipfile.ZipFile(io.BytesIO(answer.arrays["bar.pvd.zip"].tobytes())).namelist()
    assert "bar.pvd" in names
    assert len(names) == 1 + len(bent_scene().clip.times)


def test_an_export_that_is_stopped_gives_nothing(moving):
    session, page = moving
    page.ask(session, "time.clip", {"duration": 400.0})
    job = page.ask(session, "export.clip", {"suffix": ".mdd"}).head["job"]
    page.ask(session, "job.cancel", {"job": job})
    page.ask(session, "time.clip", {"duration": 0.5})
    page.ask(session, "export.clip", {"suffix": ".mdd"})  # waits for the other to end
    assert len(exported(page).arrays["bar.mdd"]) < 200_000
    assert len(page.events("exported")) == 1
    assert not page.events("failure")
