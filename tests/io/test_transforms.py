"""Which format a transform file is of: its content says so before its name does."""

from __future__ import annotations

import numpy as np
import pytest

import pliant as pl
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.transforms import FORMATS, transform_format


def test_content_comes_before_the_ending(tmp_path):
    path = tmp_path / "turn.AFF"
    pl.write_transform(pl.Affine.rotation("z", 0.5), path)
    for name in ("turn.FFD", "turn.txt", "turn"):
        renamed = tmp_path / name
        renamed.write_bytes(path.read_bytes())
        assert np.allclose(pl.read_transform(renamed).matrix, pl.Affine.rotation("z", 0.5).matrix, atol=1e-6)


def test_every_format_is_found_by_its_endings_in_any_case():
    for known in FORMATS:
        for ending in known.endings:
            assert transform_format(f"a{ending.upper()}") is known
            assert transform_format(f"a{ending}") is known


def test_what_is_not_known_is_refused_with_what_is(tmp_path):
    path = tmp_path / "mesh.obj"
    path.write_text("v 0 0 0\n")
    with pytest.raises(UnsupportedFormat, match=r"\.ffd"):
        pl.read_transform(path)
    with pytest.raises(UnsupportedFormat, match=r"\.ffd"):
        pl.write_transform(pl.Affine(), path)
    assert path.read_text() == "v 0 0 0\n"


def test_files_that_are_not_there_or_empty(tmp_path):
    with pytest.raises(UnreadableFile, match="No such file"):
        pl.read_transform(tmp_path / "none.FFD")
    (tmp_path / "empty.FFD").touch()
    with pytest.raises(UnreadableFile, match="empty"):
        pl.read_transform(tmp_path / "empty.FFD")
    (tmp_path / "text.FFD").write_text("hello")
    with pytest.raises(UnreadableFile, match="headers"):
        pl.read_transform(tmp_path / "text.FFD")
