"""The shapes made on the spot are sound."""

from __future__ import annotations

import zlib

import numpy as np
import pytest

from pliant import examples
from pliant.errors import InvalidParameter
from pliant.field.volumes import volume
from pliant.io.image_formats.png import png_bytes


@pytest.mark.parametrize(("around", "along"), [(12, 9), (96, 72)])
def test_the_vase_is_closed_and_points_outwards(around, along):
    vase = examples.vase(around=around, along=along)
    assert vase.edge_use == (0, 0)
    assert 0 < volume(vase) < np.prod(np.subtract(*vase.bounds[::-1])) / 4  # a wall, not a solid
    assert sorted(np.unique(vase.faces.lengths)) == sorted({4, around})
    assert (np.diff(vase.bounds, axis=0)[0, 2], vase.bounds[0][2]) == (240.0, 0.0)


def test_texture_coordinates_run_once_around_without_a_jump():
    vase = examples.vase(around=16, along=10)
    corners = vase.uvs.per_corner[: 4 * (len(vase.faces) - 2)].reshape(-1, 4, 2)
    assert np.ptp(corners[..., 0], axis=1).max() <= 1 / 16 + 1e-12
    assert (vase.uvs.per_corner.min(), vase.uvs.per_corner.max()) == (0.0, 1.0)


def test_swaying_keeps_heights_and_opposite_turns_cancel():
    rest = np.random.default_rng(0).normal(size=(20, 3))
    there = examples.sway(rest, turn=1.0, lean=0.2)
    assert (there[:, 2] == rest[:, 2]).all()
    still = examples.sway(rest, turn=0.0, lean=0.0)
    lowest, highest = rest[:, 2].argmin(), rest[:, 2].argmax()
    assert np.allclose(still[[lowest, highest]], rest[[lowest, highest]])


def test_png_holds_its_pixels():
    pixels = np.random.default_rng(0).integers(0, 256, (5, 7, 3)).astype(np.uint8)
    data = png_bytes(pixels)
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    assert (int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")) == (7, 5)
    at = data.index(b"IDAT")
    rows = np.frombuffer(zlib.decompress(data[at + 4 : -16]), np.uint8).reshape(5, -1)
    assert (rows[:, 0] == 0).all()
    assert (rows[:, 1:].reshape(5, 7, 3) == pixels).all()
    with pytest.raises(InvalidParameter, match="shape"):
        png_bytes(pixels[..., 0])


def test_the_glaze_is_a_checkerboard_between_bands():
    image = examples.glaze(96)
    assert len(np.unique(image.reshape(-1, 3), axis=0)) == 3
    assert len(np.unique(image[:5].reshape(-1, 3), axis=0)) == len(np.unique(image[-5:].reshape(-1, 3), axis=0)) == 1
