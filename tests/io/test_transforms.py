"""Which format a transform file is of: its content says so before its name does."""

from __future__ import annotations

import numpy as np
import pytest

import pliant as pl
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.transforms import FORMATS, formats, transform_format


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


def kinds():
    box = np.array([[0, 0, 0], [1, 1, 1.0]])
    grid = pl.to_grid(pl.Affine.translation((0.1, 0, 0)), box, shape=(3, 3, 3))
    return {
        "affine maps": pl.Affine.translation((1, 2, 3)),
        "B-splines": pl.BSplineFFD.around(box),
        "linear displacement grids": grid,
        "Bernstein lattices": pl.BezierFFD.around(box),
        "clamped B-splines": pl.ClampedFFD.around(box, shape=(5, 5, 5)),
    }


@pytest.mark.parametrize("known", FORMATS, ids=lambda known: known.name)
def test_the_table_says_what_a_format_holds(tmp_path, known):
    """Each kind that it names is written, and read as it was; each other is refused."""
    points = np.random.default_rng(0).uniform(0.3, 0.7, (50, 3))
    holds = known.conventions.holds.replace("clamped B-splines", "clamped")
    for kind, deformer in kinds().items():
        path = tmp_path / f"a{known.endings[0]}"
        if kind.replace("clamped B-splines", "clamped") not in holds:
            with pytest.raises(UnsupportedFormat):
                pl.write_transform(deformer, path)
            continue
        report = pl.write_transform(deformer, path)
        assert report.format == known.name
        again = pl.read_transform(path)
        assert np.abs(again(points) - deformer(points)).max() < 1e-6
        assert getattr(again, "direction", "push-forward") == known.conventions.direction


def test_the_table_has_a_row_a_format_and_a_word_in_every_cell():
    rows = formats()
    assert [row["format"] for row in rows] == [known.name for known in FORMATS]
    assert all(all(row.values()) and row.keys() == rows[0].keys() for row in rows)


def test_a_file_that_only_ends_like_a_transform_is_none(tmp_path):
    for name, text in (("cloud.xyz", "0.5 1 2\n3 4 5\n"), ("notes.txt", "hello\n"), ("data.h5", "x"), ("a.nii", "x")):
        path = tmp_path / name
        path.write_text(text)
        assert transform_format(path, path.read_bytes()) is None
        with pytest.raises(UnsupportedFormat):
            pl.read_transform(path)
