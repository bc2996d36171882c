"""``pliant demo`` and ``render``: what they make is what the library makes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import pliant as pl
from pliant.errors import MissingExtra

PNG = b"\x89PNG\r\n\x1a\n"


def test_makes_a_shape_a_transform_and_pictures(run, tmp_path):
    result = run("demo", "-o", tmp_path, "--json")
    assert result.exit_code == 0, result.stderr
    made = [Path(name) for name in json.loads(result.stdout)["made"]]
    assert {path.name for path in made} == {path.name for path in tmp_path.iterdir()}
    vase, swayed = pl.read(tmp_path / "vase.obj"), pl.read(tmp_path / "vase-swayed.obj")
    assert np.allclose(swayed.points, pl.read_transform(tmp_path / "sway.FFD")(vase.points), rtol=1e-12, atol=1e-9)
    assert swayed.material_library["glaze"].texture == tmp_path / "glaze.png"
    assert swayed.edge_use == vase.edge_use == (0, 0)
    for name in ("before.png", "after.png", "grid.png", "glaze.png"):
        assert (tmp_path / name).read_bytes().startswith(PNG)
    wrung = pl.read(tmp_path / "vase-wrung.obj")
    assert pl.volume(wrung) == pytest.approx(pl.volume(vase), rel=2e-3)  # it is wrung and squeezed, and none is lost
    motion = pl.read_sequence(tmp_path / "dance.glb")
    assert np.allclose([motion.points[0].min(axis=0), motion.points[0].max(axis=0)], vase.bounds, atol=1e-4)
    assert np.ptp(motion.points, axis=0).max() > 20
    with Image.open(tmp_path / "dance.gif") as dance:
        assert dance.n_frames == 16
    assert "Try next" in result.stderr
    assert (tmp_path / "before.png").read_bytes() != (tmp_path / "after.png").read_bytes()


def test_goes_without_pictures_where_nothing_can_draw(run, tmp_path, monkeypatch):
    from pliant.rendering import pictures
    from pliant.scene.animation import film

    def missing(*args, **kwargs):
        raise MissingExtra("drawing", "render")

    monkeypatch.setattr(pictures, "render", missing)
    monkeypatch.setattr(film, "draw_film", missing)
    result = run("demo", "-o", tmp_path, "--json", "-q")
    assert result.exit_code == 0
    assert "pliant[render]" in result.stderr
    assert {path.name for path in tmp_path.iterdir()} == {Path(name).name for name in json.loads(result.stdout)["made"]}


def test_what_the_demo_suggests_can_be_done(run, tmp_path, monkeypatch):
    from pliant.rendering import pictures
    from pliant.scene.animation import film

    monkeypatch.setattr(pictures, "render", lambda mesh, deformer, path, **options: Path(path).write_bytes(PNG))
    monkeypatch.setattr(
        film, "draw_film", lambda mesh, frames, **options: [np.zeros((8, 8, 3), np.uint8)] * len(frames)
    )
    result = run("demo", "-o", tmp_path)
    commands = [line.split()[1:] for line in result.stderr.splitlines() if line.startswith("  pliant ")]
    assert [words[0] for words in commands] == ["info", "deform", "render", "deform", "animate", "studio"]
    for words in commands[:-1]:  # the studio stays until it is told to go
        assert run(*words).exit_code == 0, words
    assert np.allclose(pl.read(tmp_path / "back.obj").points, pl.read(tmp_path / "vase.obj").points, atol=1e-6)


def test_renders_what_the_library_renders(run, cube, lattice, tmp_path, monkeypatch):
    from pliant.rendering import pictures

    calls = []
    monkeypatch.setattr(pictures, "render", lambda *given, **options: calls.append((given, options)))
    words = ("--show", "mesh, grid", "--color", "det", "--view", "top", "--mesh-space", "LPS")
    assert run("render", cube, "--ffd", lattice, *words, "-o", tmp_path / "a.png").exit_code == 0
    (shape, deformer, path), options = calls[0]
    assert np.allclose(shape.points * [-1, -1, 1], pl.read(cube).points)
    assert np.allclose(deformer.controls, pl.read_transform(lattice).controls)
    assert path == tmp_path / "a.png"
    assert options["show"] == ("mesh", "grid")
    assert (options["color"], options["view"]) == ("volume ratio", "top")


@pytest.mark.parametrize(("words", "code"), [(("--show", "soul"), 2), (("--view", "inside"), 2), (("-o", "a.xyz"), 3)])
def test_pictures_that_cannot_be_drawn_are_refused(run, cube, tmp_path, monkeypatch, words, code):
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.iterdir())
    assert run("render", cube, "-o", "a.png", *words).exit_code == code
    assert sorted(tmp_path.iterdir()) == before
