"""Points in pieces are moved as all at once are."""

from __future__ import annotations

import dask.array as da
import numpy as np
import pytest

import pliant as pl
from pliant.errors import InvalidTarget, UnreadableFile


@pytest.fixture
def points():
    return np.random.default_rng(0).uniform(-100, 300, (5000, 3))


def test_pieces_move_as_the_whole_does(stack, points):
    array = da.from_array(points, chunks=(700, 2))
    moved = pl.batch.stream(stack, array)
    assert moved.shape == (5000, 3)
    assert moved.dtype == np.float64
    assert np.array_equal(moved.compute(), stack(points))


@pytest.mark.parametrize("kind", [np.float32, np.float64, np.int16])
def test_files(stack, points, kind, tmp_path):
    np.save(tmp_path / "in.npy", points.astype(kind))
    assert pl.batch.stream_file(stack, tmp_path / "in.npy", tmp_path / "out.npy", rows=1024) == 5000
    assert np.array_equal(np.load(tmp_path / "out.npy"), stack(points.astype(kind).astype(float)))


def test_a_file_without_points(stack, tmp_path):
    np.save(tmp_path / "in.npy", np.empty((0, 3)))
    assert pl.batch.stream_file(stack, tmp_path / "in.npy", tmp_path / "out.npy") == 0
    assert np.load(tmp_path / "out.npy").shape == (0, 3)


def test_what_needs_the_whole_shape(stack, points):
    array = da.from_array(points)
    with pytest.raises(InvalidTarget, match="LaplacianEdit"):
        pl.batch.stream(pl.LaplacianEdit(np.arange(9), np.array([4])), array)
    with pytest.raises(InvalidTarget, match="'twist' is masked"):
        pl.batch.stream(stack.replace("twist", mask=np.ones(5000)), array)
    with pytest.raises(InvalidTarget, match="from_array"):
        pl.batch.stream(stack, points)


def test_what_is_no_file_of_points(stack, tmp_path):
    (tmp_path / "words.npy").write_text("words")
    np.save(tmp_path / "plane.npy", np.zeros((4, 2)))
    for name in ("words.npy", "plane.npy", "none.npy"):
        with pytest.raises(UnreadableFile, match=name):
            pl.batch.stream_file(stack, tmp_path / name, tmp_path / "out.npy")
    assert not (tmp_path / "out.npy").exists()


def test_points_that_are_not_finite_leave_no_output(stack, points, tmp_path):
    points[4000, 1] = np.nan
    np.save(tmp_path / "in.npy", points)
    with pytest.raises(pl.PliantError, match="not finite"):
        pl.batch.stream_file(stack, tmp_path / "in.npy", tmp_path / "out.npy", rows=512)
    assert [path.name for path in tmp_path.iterdir()] == ["in.npy"]
