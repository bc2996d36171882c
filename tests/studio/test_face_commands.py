"""Faces in the studio without a browser: a photograph becomes the scene, and sliders make the library's caricature."""

import time
from contextlib import contextmanager

import numpy as np
import pytest
import skimage.data
from pages import joined
from PIL import Image

import pliant as pl
from pliant.face.networks import MissingNetworks
from pliant.face.topology import opposite
from pliant.studio.examples.samples import ball
from pliant.studio.modes import faces


@pytest.fixture
def opened():
    yield from joined(pl.Scene(ball()), "ball")


def until(session, condition):
    end = time.monotonic() + 60
    while not session.submit(condition).result():
        assert time.monotonic() < end
        time.sleep(0.02)


def sent(session, page, image, folder, name="portrait.png"):
    """A photograph, uploaded."""
    Image.fromarray(image).save(folder / name)
    data = (folder / name).read_bytes()
    upload = page.ask(session, "upload.begin", {"files": [{"name": name, "size": len(data)}]}).head["upload"]
    page.ask(session, "upload.chunk", {"upload": upload, "file": 0}, bytes=np.frombuffer(data, np.uint8))
    return upload


@pytest.fixture(scope="module")
def dropped(tmp_path_factory):
    """A session on the face of a dropped photograph."""
    with contextmanager(joined)(pl.Scene(ball()), "ball") as (session, page):
        upload = sent(session, page, skimage.data.astronaut(), tmp_path_factory.mktemp("photographs"))
        assert page.ask(session, "open.upload", {"upload": upload}).head["photograph"] == "portrait.png"
        page.ask(session, "face.open", {"upload": upload})
        until(session, lambda: "Caricature" in session.scene.stack.names)
        yield session, page


@pytest.fixture
def portrait(dropped):
    """The same, at the beginning of its history."""
    yield dropped
    session, page = dropped
    page.ask(session, "history.goto", {"position": 0})


LAYER = {"layer": "Caricature"}


@pytest.fixture(scope="module")
def face():
    return pl.face_from_photo(skimage.data.astronaut())


@pytest.fixture(scope="module")
def dense(face):
    return pl.dense_face(face).filled()


def test_a_photograph_becomes_the_scene(portrait, face, dense):
    session, page = portrait
    np.testing.assert_allclose(session.scene.deformed().points, dense.mesh.points, atol=1e-9)
    assert session.name == "portrait"
    assert page.events("enter")[-1].head["mode"] == "face"
    seen = page.ask(session, "face.get", LAYER)
    np.testing.assert_allclose(seen.arrays["landmarks"].reshape(-1, 3), face.landmarks, atol=1e-5)
    assert (seen.head["number"], seen.head["count"]) == (0, 1)
    picture = page.ask(session, "mesh.texture", {"id": 0}).arrays["file"].tobytes()
    assert picture == face.picture.png()


def test_sliders_make_the_caricature_of_the_library(portrait, dense):
    session, page = portrait
    page.ask(session, "preview.begin", LAYER)
    page.ask(session, "preview.move", {"fields": {"amount": 0.5}})
    page.ask(session, "preview.commit")
    page.ask(session, "layers.fields", {**LAYER, "fields": {"nose": 1.6, "mouth": 0.2}})
    expected = pl.caricature(dense, 0.5, {"nose": 1.6, "mouth": 0.2})
    assert expected.amount == 0.5
    np.testing.assert_allclose(session.scene.deformed().points, expected.face.mesh.points, atol=1e-9)
    seen = page.ask(session, "face.get", LAYER).arrays["landmarks"].reshape(-1, 3)
    np.testing.assert_allclose(seen, expected.face.landmarks, atol=1e-5)
    found = page.ask(session, "face.folds", LAYER).head
    assert not found["folds"]
    assert found["least"] == pytest.approx(expected.least)


def test_what_folds_is_reduced_until_it_does_not(portrait):
    session, page = portrait
    page.ask(session, "layers.fields", {**LAYER, "fields": {"amount": 3.0, "mouth": 3.0, "eyes": 3.0}})
    found = page.ask(session, "face.folds", LAYER).head
    assert found["folds"]
    page.ask(session, "face.reduce", LAYER)
    reduced = session.scene.stack["Caricature"].deformer.amount
    assert reduced == pytest.approx(found["amount"])
    assert 0 < reduced < 3
    assert page.ask(session, "face.folds", LAYER).head["least"] > 0


def test_handles_go_under_the_caricature_once(portrait):
    session, page = portrait
    for _ in range(2):
        assert page.ask(session, "face.handles", LAYER).head["layer"] == "Handles"
    assert session.scene.stack.names == ("Handles", "Caricature")
    assert session.history.position == 1


def test_a_photograph_of_no_face_says_so_and_changes_nothing(opened, tmp_path):
    session, page = opened
    before = session.scene
    page.ask(session, "face.open", {"upload": sent(session, page, skimage.data.coffee(), tmp_path)})
    until(session, lambda: page.events("failure"))
    assert "no face is found in the picture of 600 × 400 pixels" in page.events("failure")[-1].head["message"]
    assert session.scene is before
    page.ask(session, "face.open", {"upload": sent(session, page, skimage.data.astronaut(), tmp_path), "number": 4})
    until(session, lambda: len(page.events("failure")) > 1)
    assert "there is no face 4" in page.events("failure")[-1].head["message"]


def test_the_faces_of_a_photograph_are_gone_through(opened, tmp_path):
    session, page = opened
    one = skimage.data.astronaut()[:300, 100:350]
    smaller = np.asarray(Image.fromarray(one).resize((200, 240)))
    both = np.full((300, 500, 3), 128, np.uint8)
    both[:, :250], both[30:270, 275:475] = one, smaller[:, ::-1]
    page.ask(session, "face.open", {"upload": sent(session, page, both, tmp_path)})
    until(session, lambda: "Caricature" in session.scene.stack.names)
    first = session.scene.stack["Caricature"].deformer.landmarks
    assert page.ask(session, "face.get", LAYER).head["count"] == 2
    page.ask(session, "face.other", {"number": 1})
    until(session, lambda: session.beside.get("photograph", (None, 0, 0))[1] == 1)
    second = session.scene.stack["Caricature"].deformer.landmarks
    apart = np.abs(
        second * [-1, 1, 1] - first[opposite()]
    ).max()  # the same face in a mirror, but for the network's noise
    assert 0.01 < apart < 1.0


def test_a_missing_extra_is_told_with_the_command_that_brings_it(opened, monkeypatch):
    session, page = opened
    assert page.ask(session, "face.ready").head == {"answer": 1, "missing": "", "example": True}

    def gone(name):
        raise MissingNetworks("the package 'ai-edge-litert'")

    monkeypatch.setattr("pliant.face.networks.network", gone)
    monkeypatch.setattr(faces, "find_spec", lambda name: None)
    told = page.ask(session, "face.ready").head
    assert "pip install 'pliant[face]'" in told["missing"]
    assert not told["example"]
    assert "scikit-image" in page.refused(session, "face.open")["message"]


def test_what_makes_no_sense_is_refused_by_name(opened, tmp_path):
    session, page = opened
    for command in ("face.get", "face.folds", "face.reduce", "face.handles"):
        assert "Caricature" in page.refused(session, command, LAYER)["message"]
    assert "not at hand" in page.refused(session, "face.other", {"number": 1})["message"]
