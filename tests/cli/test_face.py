"""``pliant face`` does what the library does, and fails with one line."""

from __future__ import annotations

import json

import numpy as np
import pytest
import skimage.data
from PIL import Image

import pliant as pl


@pytest.fixture(scope="module")
def photo(tmp_path_factory):
    path = tmp_path_factory.mktemp("photo") / "photo.png"
    Image.fromarray(skimage.data.astronaut()).save(path)
    return path


def test_a_photograph_becomes_a_caricature(run, photo, tmp_path):
    out = tmp_path / "face.obj"
    result = run("face", photo, "-o", out, "--caricature", "0.8", "--group", "nose=1.2", "--json", "-q")
    assert result.exit_code == 0, result.stderr
    expected = pl.caricature(pl.face_from_photo(photo), 0.8, {"nose": 1.2})
    mesh = pl.read(out)
    assert np.allclose(mesh.points, expected.face.mesh.points, atol=1e-9)
    assert mesh.material_library["skin"].texture.name == "face.png"
    facts = json.loads(result.stdout)
    assert facts["points"] == 468
    assert facts["caricature"]["least_det"] == pytest.approx(expected.least)
    assert facts["caricature"]["amount"] == 0.8
    assert len(facts["faces"]) == 1


def test_dense_and_filled_and_towards_the_mean(run, photo, tmp_path):
    out = tmp_path / "face.glb"
    words = ("--dense", "--filled", "--caricature", "-0.3", "--by", "lattice", "--expression", "1")
    result = run("face", photo, "-o", out, *words)
    assert result.exit_code == 0, result.stderr
    assert "proved everywhere" in result.stderr
    assert "6,990 points, 13,635 faces" in result.stderr
    assert "assuming a face 14 cm wide" in result.stderr


@pytest.mark.parametrize(
    ("words", "code", "cause"),
    [
        (("--group", "nose=1.2"), 2, "--caricature"),
        (("--caricature", "1", "--group", "nose"), 2, "nose=1.2"),
        (("--caricature", "1", "--group", "ears=2"), 2, "no feature is called 'ears'"),
        (("--caricature", "99"), 2, "caricature"),
        (("--face", "3"), 3, "there is no face 3"),
    ],
)
def test_what_is_wrong_is_said_and_nothing_is_written(run, photo, tmp_path, words, code, cause):
    result = run("face", photo, "-o", tmp_path / "face.obj", *words)
    assert result.exit_code == code
    assert cause in " ".join(result.stderr.replace("│", " ").split())
    assert not list(tmp_path.iterdir())


def test_pictures_without_a_face_and_files_without_a_picture(run, tmp_path):
    Image.fromarray(skimage.data.rocket()).save(tmp_path / "rocket.png")
    (tmp_path / "text.jpg").write_text("no picture")
    for name, cause in (("rocket.png", "no face is found"), ("text.jpg", "cannot be read as a picture")):
        result = run("face", tmp_path / name, "-o", tmp_path / "out" / "face.obj")
        assert result.exit_code == 3
        assert cause in result.stderr
        assert not (tmp_path / "out").exists()
