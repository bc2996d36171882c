"""Grids of quadrangles that close: the six sides of a cube, and rings around an axis."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points

Faces = list[NDArray[np.int32]]


def cube_sphere(cells: int) -> tuple[Points, NDArray[np.int32]]:
    """Directions (n, 3) of unit length, and the quadrangles (6 cells², 4) of a cube blown up.

    Steps along a side are equal angles, so that quadrangles differ little in size.
    """
    steps = np.tan(np.linspace(-np.pi / 4, np.pi / 4, cells + 1))
    u, v = np.meshgrid(steps, steps, indexing="ij")
    at = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    cell = np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], axis=-1).reshape(-1, 4)
    sides: list[Points] = []
    faces = []
    for axis in range(3):
        for sign in (1.0, -1.0):
            side = np.empty((u.size, 3))
            side[:, axis], side[:, (axis + 1) % 3], side[:, (axis + 2) % 3] = sign, u.ravel(), v.ravel()
            faces.append((cell if sign > 0 else cell[:, ::-1]) + len(sides) * u.size)
            sides.append(side)
    points = np.concatenate(sides)
    _, first, merged = np.unique(points.round(12) + 0.0, axis=0, return_index=True, return_inverse=True)
    unit = points[first] / np.linalg.norm(points[first], axis=1, keepdims=True)
    return unit, merged.reshape(-1)[np.concatenate(faces)].astype(np.int32)


def lathe(radii: NDArray[np.float64], heights: NDArray[np.float64], around: int) -> tuple[Points, Faces]:
    """A closed outline of radii and heights, from below, turned about z; radius 0 is a pole, others get lids."""
    angle = 2 * np.pi * np.arange(around) / around
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points: list[tuple[float, float, float]] = []
    rings = []
    for radius, height in zip(radii, heights, strict=True):
        count = 1 if radius == 0 else around
        rings.append(np.full(around, len(points)) if count == 1 else len(points) + np.arange(around))
        points += [(radius * circle[i, 0], radius * circle[i, 1], height) for i in range(count)]
    faces: Faces = []
    for low, high in pairwise(rings):
        for i in range(around):
            j = (i + 1) % around
            corners = np.array([low[i], low[j], high[j], high[i]], np.int32)
            faces.append(corners[np.sort(np.unique(corners, return_index=True)[1])])
    lids = [(rings[0][::-1], radii[0]), (rings[-1], radii[-1])]
    faces += [np.asarray(ring, np.int32) for ring, radius in lids if radius > 0]
    return np.array(points, np.float64), faces


def ring_of_rings(radius: float, tube: float, around: int, across: int) -> tuple[Points, NDArray[np.int32]]:
    """A torus about z: points (around · across, 3) and its quadrangles."""
    u, v = np.meshgrid(2 * np.pi * np.arange(around) / around, 2 * np.pi * np.arange(across) / across, indexing="ij")
    out = radius + tube * np.cos(v)
    points = np.stack([out * np.cos(u), out * np.sin(u), tube * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
    faces = np.stack([(a % around) * across + b % across for a, b in corners], axis=-1).reshape(-1, 4)
    return points, faces.astype(np.int32)
