"""Shapes to try the studio on, made on the spot."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.examples import glaze, vase
from pliant.io.files import write_bytes
from pliant.io.image_formats.png import png_bytes
from pliant.mesh import CornerValues, FaceLabels, Material, PolygonMesh
from pliant.numerics.ragged import Ragged

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Sample:
    """A shape on the start page.

    Parameters
    ----------
    title
        What it is called.
    points
        How many it has.
    make
        What makes it.
    """

    title: str
    points: int
    make: Callable[[], PolygonMesh]


def sample(name: str) -> PolygonMesh:
    """A shape of the start page.

    Raises
    ------
    InvalidParameter
        There is none of that name.
    """
    if name not in SAMPLES:
        raise InvalidParameter(f"there is no example {name!r}; there are: {', '.join(SAMPLES)}")
    return SAMPLES[name].make()


def torus(around: int = 96, across: int = 40, big: float = 1.0, small: float = 0.38) -> PolygonMesh:
    """A torus of quadrangles about z, with texture coordinates."""
    u, v = _parameters(around, across)
    ring = big + small * np.cos(2 * np.pi * v)
    points = np.stack(
        [ring * np.cos(2 * np.pi * u), ring * np.sin(2 * np.pi * u), small * np.sin(2 * np.pi * v)], axis=-1
    )
    return _wrapped(points, checkers(12, 5))


def bar(length: float = 4.0, width: float = 0.8, along: int = 60, across: int = 10) -> PolygonMesh:
    """A square bar along x, of quadrangles."""
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * width / 2
    side = np.linspace(0, 1, across, endpoint=False)[:, None]
    outline = np.concatenate([corners[i] + side * (corners[(i + 1) % 4] - corners[i]) for i in range(4)])
    x = np.linspace(-length / 2, length / 2, along + 1)
    points = np.empty((along + 1, len(outline), 3))
    points[..., 0], points[..., 1:] = x[:, None], outline
    return _capped(points)


def column(height: float = 4.0, radius: float = 0.32, along: int = 96, around: int = 40) -> PolygonMesh:
    """A round column that stands on z = 0, with a foot and a head that are a little wider."""
    part = np.linspace(0, 1, along + 1)
    wide = radius * (1 + 0.55 * np.exp(-((part / 0.07) ** 2)) + 0.35 * np.exp(-(((1 - part) / 0.06) ** 2)))
    angle = 2 * np.pi * np.arange(around) / around
    points = np.empty((along + 1, around, 3))
    points[..., 0], points[..., 1] = wide[:, None] * np.cos(angle), wide[:, None] * np.sin(angle)
    points[..., 2] = height * part[:, None]
    return _capped(points)


def egg(around: int = 72, along: int = 48) -> PolygonMesh:
    """A head-sized egg with two dents for eyes and a bump for a nose: something to pull at."""
    u, v = _parameters(around, along)
    polar = np.pi * (0.985 * v + 0.0075)
    direction = np.stack(
        [np.sin(polar) * np.cos(2 * np.pi * u), np.sin(polar) * np.sin(2 * np.pi * u), np.cos(polar)], axis=-1
    )
    radius = 1 + 0.12 * direction[..., 2]
    for place, height, width in (
        ((0, -1, 0.05), 0.22, 0.16),
        ((0.33, -0.9, 0.3), -0.1, 0.16),
        ((-0.33, -0.9, 0.3), -0.1, 0.16),
    ):
        toward = np.array(place) / np.linalg.norm(place)
        radius = radius + height * np.exp(-(np.linalg.norm(direction - toward, axis=-1) ** 2) / (2 * width**2))
    return _capped(np.swapaxes(radius[..., None] * direction * [0.82, 0.92, 1.15], 0, 1)[::-1])


def ball(around: int = 64, along: int = 32) -> PolygonMesh:
    """A unit sphere of quadrangles."""
    u, v = _parameters(around, along)
    polar = np.pi * (0.985 * v + 0.0075)
    points = np.stack(
        [np.sin(polar) * np.cos(2 * np.pi * u), np.sin(polar) * np.sin(2 * np.pi * u), np.cos(polar)], axis=-1
    )
    return _capped(np.swapaxes(points, 0, 1)[::-1])


def textured_vase() -> PolygonMesh:
    """The vase with its glaze."""
    return vase(texture=_picture("glaze.png", glaze()))


def checkers(columns: int, rows: int, size: int = 512) -> Path:
    """A checkerboard in two colours, as a picture file."""
    u, v = np.meshgrid(np.arange(size) / size, np.arange(size) / size)
    tile = (np.floor(2 * columns * u) + np.floor(2 * rows * v)).astype(int) % 2
    return _picture(f"checkers-{columns}-{rows}.png", np.array([(236, 239, 244), (66, 118, 184)], np.uint8)[tile])


def samples_folder() -> Path:
    """Where the samples' textures are."""
    return Path(_folder().name)


def _picture(name: str, pixels: NDArray[np.uint8]) -> Path:
    path = samples_folder() / name
    write_bytes(path, png_bytes(pixels))
    return path


@cache
def _folder() -> tempfile.TemporaryDirectory[str]:
    """Where the samples' textures are, as long as the program runs."""
    return tempfile.TemporaryDirectory(prefix="pliant-samples-")


def _parameters(around: int, across: int) -> tuple[Floats, Floats]:
    """(around, across) parameters: u closes in itself, v ends before one where it closes, at one where not."""
    u = np.arange(around) / around
    v = np.arange(across) / across
    first, second = np.meshgrid(u, v, indexing="ij")
    return first, second


def _wrapped(points: Floats, texture: Path) -> PolygonMesh:
    """Quadrangles over a grid of points that closes in both directions."""
    rows, columns = points.shape[:2]
    i, j = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    around = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
    faces = np.stack([(a % rows) * columns + b % columns for a, b in around], axis=-1).reshape(-1, 4)
    corners = np.stack([a * (columns + 1) + b for a, b in around], axis=-1).reshape(-1)
    u, v = np.meshgrid(np.linspace(0, 1, rows + 1), np.linspace(0, 1, columns + 1), indexing="ij")
    return PolygonMesh(
        points.reshape(-1, 3),
        Ragged.of(faces),
        uvs=CornerValues(np.stack([u, v], axis=-1).reshape(-1, 2), corners.astype(np.int32)),
        materials=FaceLabels(("checkers",), np.zeros(len(faces), np.int32)),
        material_library={"checkers": Material("checkers", (0.8, 0.8, 0.8), texture)},
    )


def _capped(rings: Floats) -> PolygonMesh:
    """Quadrangles between rings of points, and a polygon at either end."""
    count, around = rings.shape[:2]
    i, j = np.meshgrid(np.arange(count - 1), np.arange(around), indexing="ij")
    corners = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
    quads = np.stack([a * around + b % around for a, b in corners], axis=-1).reshape(-1)
    last = (count - 1) * around + np.arange(around)
    flat = np.concatenate([quads, np.arange(around)[::-1], last]).astype(np.int32)
    lengths = np.concatenate([np.full(len(quads) // 4, 4), [around, around]])
    faces = Ragged(flat, np.concatenate([[0], np.cumsum(lengths)]))
    return PolygonMesh(rings.reshape(-1, 3), faces)


SAMPLES = {
    "vase": Sample("Vase", 96 * 145, textured_vase),
    "torus": Sample("Torus", 96 * 40, torus),
    "bar": Sample("Bar", 61 * 40, bar),
    "sphere": Sample("Ball", 64 * 32, ball),
    "head": Sample("Egg head", 72 * 48, egg),
}
