"""A pair of shapes to try deformation transfer on: a bar that bends and twists, and an arm that has never done so."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points, PolygonMesh
from pliant.numerics.ragged import Ragged
from pliant.space.bend import Bend
from pliant.space.taper import Taper
from pliant.space.twist import Twist
from pliant.studio.examples.samples import bar
from pliant.studio.modes.transferring import Bench

_RINGS, _AROUND = 44, 28


def arm() -> PolygonMesh:
    """A round arm along x with muscles, a wrist and a fist: of triangles, where the bar is of quadrangles."""
    along = np.linspace(0, 1, _RINGS)
    x = 2.05 * (2 * along - 1)
    radius = 0.42 + 0.1 * np.exp(-(((along - 0.25) / 0.12) ** 2)) - 0.12 * np.exp(-(((along - 0.78) / 0.07) ** 2))
    radius = radius + 0.07 * np.exp(-(((along - 0.55) / 0.1) ** 2))
    ends = np.sqrt(np.clip(1 - np.clip(1 - np.minimum(along, 1 - along) / 0.1, 0, 1) ** 2, 0.02, 1))
    angle = 2 * np.pi * np.arange(_AROUND) / _AROUND
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    points = np.empty((_RINGS, _AROUND, 3))
    points[..., 0] = x[:, None]
    points[..., 1:] = (radius * ends)[:, None, None] * ring
    tips = np.array([[x[0] - 0.01, 0, 0], [x[-1] + 0.01, 0, 0]])
    return PolygonMesh(np.vstack([points.reshape(-1, 3), tips]), Ragged.of(_triangles()))


def posed_bar(target: PolygonMesh) -> Bench:
    """The bar with three poses, and markers on it and on the arm."""
    source = bar(along=40, across=8)
    poses = {
        "bent": Bend(axis="y", normal="z", angle=1.3, bounds=(-1.0, 1.0))(source).points,
        "twisted": Twist(axis="x", angle=2.2, bounds=(-1.6, 1.6))(source).points,
        "thin": Taper(axis="x", factor=0.55, bounds=(-2.0, 2.0))(source).points,
    }
    bench = Bench("Bar", source, poses)
    bench.mark(_markers(source, target), target)
    return bench


def _markers(source: PolygonMesh, target: PolygonMesh) -> NDArray[np.int64]:
    """Rings of four markers along both, at the same places of the way."""
    places = np.array([[x, y, z] for x in (-1.6, -0.6, 0.6, 1.6) for y, z in ((1, 0), (0, 1), (-1, 0), (0, -1))])
    pairs = [[_nearest(mesh.points, place * [1, 0.4, 0.4]) for mesh in (source, target)] for place in places]
    return np.array(pairs, np.int64)


def _nearest(points: Points, place: Points) -> int:
    return int(np.linalg.norm(points - place, axis=1).argmin())


def _triangles() -> NDArray[np.int32]:
    i, j = np.meshgrid(np.arange(_RINGS - 1), np.arange(_AROUND), indexing="ij")
    one, two = i * _AROUND + j, i * _AROUND + (j + 1) % _AROUND
    sides = np.stack([one, two, two + _AROUND, one, two + _AROUND, one + _AROUND], axis=-1).reshape(-1, 3)
    k = np.arange(_AROUND)
    first, last = _RINGS * _AROUND, (_RINGS - 1) * _AROUND
    low = np.column_stack([np.full(_AROUND, first), (k + 1) % _AROUND, k])
    high = np.column_stack([np.full(_AROUND, first + 1), last + k, last + (k + 1) % _AROUND])
    return np.vstack([sides, low, high]).astype(np.int32)
