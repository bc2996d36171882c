"""Parts from CAD by way of the commands that deform meshes."""

from __future__ import annotations

import orjson
import pytest
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder

import pliant as pl
from pliant import cad
from pliant.cad.labels import Label


@pytest.fixture
def rod(tmp_path):
    path = tmp_path / "rod.step"
    cad.write(cad.Part(BRepPrimAPI_MakeCylinder(5.0, 40.0).Shape()), path)
    return path


def test_a_part_is_deformed_and_stays_one(run, rod, tmp_path):
    out = tmp_path / "twisted.step"
    done = run("deform", rod, "--taper", "axis=z,factor=0.5", "--tolerance", "0.01", "-o", out, "--json")
    assert done.exit_code == 0
    assert orjson.loads(done.stdout)["valid"] is True
    taper = pl.Taper.around(cad.read(rod).mesh(), axis="z", factor=0.5)
    expected = cad.read(rod).deformed(taper, tolerance=0.01)
    assert cad.read(out).volume == pytest.approx(expected.volume, rel=1e-6)


def test_a_recipe_deforms_a_part_into_triangles(run, rod, tmp_path):
    out = tmp_path / "twisted.ply"
    assert run("apply", "twist-up", rod, "-o", out, "--tolerance", "0.05").exit_code == 0
    assert pl.volume(pl.read(out)) == pytest.approx(cad.read(rod).volume, rel=0.02)


def test_what_a_part_holds(run, rod):
    told = orjson.loads(run("info", rod, "--json").stdout)
    assert (told["kind"], told["solids"], told["faces"], told["valid"]) == ("part", 1, 3, True)


def test_names_and_colours_come_along(run, tmp_path):
    red = Label("solid", 0, "rod", "", (1.0, 0.0, 0.0, 1.0))
    cad.write(cad.Part(BRepPrimAPI_MakeCylinder(5.0, 40.0).Shape(), (red,)), tmp_path / "red.step")
    done = run("apply", "twist-up", tmp_path / "red.step", "-o", tmp_path / "out.step", "--tolerance", "0.05", "--json")
    assert orjson.loads(done.stdout)["losses"] == []
    assert cad.read(tmp_path / "out.step").labels == (red,)
    assert orjson.loads(run("info", tmp_path / "out.step", "--json").stdout)["names"] == ["rod"]


def test_a_file_that_is_no_part(run, tmp_path):
    (tmp_path / "words.step").write_text("words")
    done = run("deform", tmp_path / "words.step", "--twist", "angle=90", "-o", tmp_path / "out.step")
    assert done.exit_code == 3
    assert not (tmp_path / "out.step").exists()
