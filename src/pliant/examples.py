"""Shapes to try things on, made on the spot: nothing has to be downloaded."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.mesh import CornerValues, FaceLabels, Material, PolygonMesh
from pliant.numerics.ragged import Ragged

Floats = NDArray[np.float64]

_RADII = (0.34, 0.30, 0.62, 1.02, 0.30, 0.02, 0.16, 0.44)  # Bernstein coefficients of the vase's outline, foot to lip
_GLAZES = ((244, 234, 216), (22, 92, 104), (196, 98, 56))  # cream, teal, copper


def vase(height: float = 240.0, around: int = 96, along: int = 72, texture: Path | None = None) -> PolygonMesh:
    """A closed vase with an inside: quadrangles, a polygon for the foot and one for the floor, and texture coordinates.

    Parameters
    ----------
    height
        From the foot, at z = 0, to the lip; the axis is z.
    around, along
        How many quadrangles there are around, and from foot to lip.
    texture
        The image of the material; see :func:`glaze`.
    """
    outside = np.linspace(0.0, 1.0, along + 1)
    inside = np.linspace(1.0, 0.06, along)
    wall = 0.024 * np.minimum(1.0, (1.0 - inside) * 20)  # the lip is round: the wall grows below it
    rows = np.concatenate([outside, inside])
    radii = _bernstein(outside), _bernstein(inside) - 0.014 - wall
    radius = np.concatenate(radii)
    angle = np.linspace(0.0, 2 * np.pi, around, endpoint=False)
    flutes = 1 + 0.025 * np.cos(12 * angle) * np.sin(np.pi * rows[:, None]) ** 2
    ring = np.maximum(radius, 0.05)[:, None] * flutes * height / 2
    z = np.broadcast_to(rows[:, None] * height, ring.shape)
    points = np.stack([ring * np.cos(angle), ring * np.sin(angle), z], axis=-1).reshape(-1, 3)
    faces, corners = _tube(len(rows), around)
    u, v = np.meshgrid(np.linspace(0, 1, around + 1), np.where(np.arange(len(rows)) <= along, rows, 0.97))
    uvs = CornerValues(np.stack([u, v], axis=-1).reshape(-1, 2), corners)
    return PolygonMesh(
        points,
        faces,
        uvs=uvs,
        materials=FaceLabels(("glaze",), np.zeros(len(faces), np.int32)),
        material_library={"glaze": Material("glaze", (0.8, 0.8, 0.8), texture)},
    )


def glaze(size: int = 768) -> NDArray[np.uint8]:
    """(size, size, 3) colours: a checkerboard in two glazes between two bands of a third."""
    column, row = np.meshgrid(np.arange(size) / size, 1 - np.arange(size) / size)
    tile = (np.floor(24 * column) + np.floor(16 * row)) % 2
    tile = np.where((row < 0.06) | (row > 0.94), 2, tile).astype(int)
    colors: NDArray[np.uint8] = np.array(_GLAZES, np.uint8)[tile]
    return colors


def sway(positions: ArrayLike, *, turn: float = 1.0, lean: float = 0.15) -> Floats:
    """Where lattice positions (..., 3) go in a dance: they turn about z with height and lean aside in an S.

    Parameters
    ----------
    positions
        At rest; heights are measured from their lowest to their highest.
    turn
        Radians between the lowest and the highest.
    lean
        How far they lean, as part of the height.
    """
    rest = np.asarray(positions, np.float64)
    low, high = rest[..., 2].min(), rest[..., 2].max()
    part = (rest[..., 2] - low) / (high - low)
    swell = 1 + 0.14 * np.sin(2 * np.pi * part)
    cosine, sine = np.cos(turn * part) * swell, np.sin(turn * part) * swell
    x = cosine * rest[..., 0] - sine * rest[..., 1] + lean * (high - low) * np.sin(1.6 * np.pi * part)
    y = sine * rest[..., 0] + cosine * rest[..., 1]
    return np.stack([x, y, rest[..., 2]], axis=-1)


def _bernstein(t: Floats) -> Floats:
    """The outline's radius at parts t of the height, by de Casteljau's scheme."""
    levels = np.repeat(np.array(_RADII)[:, None], len(t), axis=1)
    while len(levels) > 1:
        levels = (1 - t) * levels[:-1] + t * levels[1:]
    result: Floats = levels[0]
    return result


def _tube(rings: int, around: int) -> tuple[Ragged, NDArray[np.int32]]:
    """Faces of a closed tube of rings with a polygon at either end, and the corners' texture coordinates."""
    ring, step = np.meshgrid(np.arange(rings - 1), np.arange(around), indexing="ij")
    corners = [(ring, step), (ring, step + 1), (ring + 1, step + 1), (ring + 1, step)]
    quads = np.stack([r * around + s % around for r, s in corners], axis=-1).reshape(-1)
    texture = np.stack([r * (around + 1) + s for r, s in corners], axis=-1).reshape(-1)
    foot = np.arange(around)[::-1]
    last = np.arange(around)
    flat = np.concatenate([quads, foot, (rings - 1) * around + last])
    lengths = np.concatenate([np.full(len(quads) // 4, 4), [around, around]])
    uv = np.concatenate([texture, foot, (rings - 1) * (around + 1) + last])
    return Ragged(flat.astype(np.int32), np.concatenate([[0], np.cumsum(lengths)])), uv.astype(np.int32)
