"""Shapes for the gallery, made on the spot: quadrangles with texture coordinates."""

from __future__ import annotations

import numpy as np

from pliant import PolygonMesh
from pliant.mesh import CornerValues


def trefoil(along: int = 400, around: int = 40, radius: float = 0.42) -> PolygonMesh:
    """A closed tube around the trefoil knot, about 6 × 6 × 3."""
    t = np.linspace(0, 2 * np.pi, along, endpoint=False)
    centers = np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -1.1 * np.sin(3 * t)], axis=1)
    tangents = np.roll(centers, -1, axis=0) - np.roll(centers, 1, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    first = np.cross(tangents, [0, 0, 1.0])
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return _tube(centers, first, np.cross(tangents, first), np.full(along, radius), around, repeats=(60, 6))


def shell(turns: float = 3.2, along: int = 420, around: int = 56) -> PolygonMesh:
    """A sea shell: a circle that grows as it winds about z; open at both ends."""
    t = np.linspace(0, 1, along)
    angle, growth = 2 * np.pi * turns * t, np.exp(2.1 * (t - 1))
    outwards = np.stack([np.cos(angle), np.sin(angle), 0 * t], axis=1)
    up = np.tile([0.0, 0.0, 1.0], (along, 1))
    centers = growth[:, None] * outwards + (3.4 * (1 - growth))[:, None] * up
    return _tube(centers, outwards, up, 0.8 * growth, around, closed=False, repeats=(64, 8))


def globe(along: int = 60, around: int = 96) -> PolygonMesh:
    """A closed ball of quadrangles, of radius one."""
    t, turn = np.pi * (np.arange(along) + 0.5) / along, np.linspace(0, 2 * np.pi, around, endpoint=False)
    rings = np.stack([np.outer(np.sin(t), f(turn)) for f in (np.cos, np.sin)] + [np.outer(np.cos(t), turn * 0 + 1)], -1)
    row = np.arange(around)
    ring, step = np.meshgrid(np.arange(along - 1), row, indexing="ij")
    places = [(ring, step), (ring + 1, step), (ring + 1, step + 1), (ring, step + 1)]
    quads = np.stack([r * around + s % around for r, s in places], axis=-1).reshape(-1, 4)
    return PolygonMesh(rings.reshape(-1, 3), [*quads, row, (along - 1) * around + row[::-1]])


def _tube(centers, first, second, radii, around, *, closed=True, repeats=(1, 1)) -> PolygonMesh:
    """A tube of quadrangles through circles that two unit vectors span at each centre."""
    rings = len(centers)
    turn = np.linspace(0, 2 * np.pi, around, endpoint=False)
    circle = np.cos(turn)[:, None] * first[:, None] + np.sin(turn)[:, None] * second[:, None]
    points = centers[:, None] + radii[:, None, None] * circle
    ring, step = np.meshgrid(np.arange(rings if closed else rings - 1), np.arange(around), indexing="ij")
    corners = [(ring, step), (ring, step + 1), (ring + 1, step + 1), (ring + 1, step)]
    quads = np.stack([(r % rings) * around + s % around for r, s in corners], axis=-1).reshape(-1, 4)
    texture = np.stack([r * (around + 1) + s for r, s in corners], axis=-1).reshape(-1)
    u, v = np.meshgrid(np.linspace(0, 1, rings + 1), np.linspace(0, 1, around + 1), indexing="ij")
    places = np.stack([u * repeats[0], v * repeats[1]], axis=-1).reshape(-1, 2) / 16
    return PolygonMesh(points.reshape(-1, 3), quads, uvs=CornerValues(places, texture))


def pillar(width: float = 1.0, height: float = 4.0, cells: int = 24) -> PolygonMesh:
    """A closed square pillar that stands on the origin, of small quadrangles, with a checkerboard's coordinates."""
    counts = np.array([cells, cells, int(cells * height / width)])
    size = np.array([width, width, height])
    points, faces, places = [], [], []
    for axis in range(3):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        for end in (0, 1):
            u, v = np.meshgrid(np.arange(counts[i] + 1), np.arange(counts[j] + 1), indexing="ij")
            side = np.zeros((u.size, 3))
            side[:, i], side[:, j], side[:, axis] = u.ravel() / counts[i], v.ravel() / counts[j], end
            first = (np.arange(counts[i])[:, None] * (counts[j] + 1) + np.arange(counts[j])).reshape(-1, 1)
            corner = first + np.array([0, counts[j] + 1, counts[j] + 2, 1])[:: 1 if end else -1]
            faces.append(corner + sum(map(len, points)))
            points.append(side * size - [width / 2, width / 2, 0])
            places.append(np.stack([u.ravel(), v.ravel()], axis=1) / 48)
    faces = np.vstack(faces)
    unique, index = np.unique(np.round(np.vstack(points), 9), axis=0, return_inverse=True)
    return PolygonMesh(unique, index.reshape(-1)[faces], uvs=CornerValues(np.vstack(places), faces.reshape(-1)))
