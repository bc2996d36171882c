"""STEP and IGES: out and in again."""

from __future__ import annotations

import numpy as np
import pytest

import pliant as pl
from pliant import cad
from pliant.errors import UnreadableFile, UnsupportedFormat


def test_step_keeps_the_solid(bracket, tmp_path, capfd):
    bent = bracket.deformed(pl.Bend(axis="z", angle=0.5, bounds=(0, 60), normal="x"), tolerance=1e-2)
    cad.write(bent, tmp_path / "bent.step")
    again = cad.read(tmp_path / "bent.step")
    assert again.valid
    assert repr(again) == repr(bent)
    assert again.volume == pytest.approx(bent.volume, rel=1e-9)
    assert capfd.readouterr().out == ""
    assert b"B_SPLINE_SURFACE_WITH_KNOTS" in (tmp_path / "bent.step").read_bytes()


def test_iges_keeps_the_surfaces(bracket, tmp_path):
    cad.write(bracket, tmp_path / "bracket.igs")
    again = cad.read(tmp_path / "bracket.igs")
    assert np.allclose(again.mesh().bounds, bracket.mesh().bounds, atol=0.1)


def test_what_is_no_part(bracket, tmp_path):
    (tmp_path / "words.step").write_text("words")
    with pytest.raises(UnreadableFile, match="no shape"):
        cad.read(tmp_path / "words.step")
    with pytest.raises(UnreadableFile, match="No such file"):
        cad.read(tmp_path / "none.step")
    with pytest.raises(UnsupportedFormat, match="STEP"):
        cad.write(bracket, tmp_path / "bracket.obj")
