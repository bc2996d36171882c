"""Bodies with limbs, made of round bars that grow together."""

from __future__ import annotations

from functools import cache

import numpy as np
from skimage.measure import marching_cubes

from pliant.mesh import PolygonMesh

FIGURE = [
    ([0, 0, 0.0], [0, 0, 0.9], 0.22),  # trunk
    ([0, 0, 1.0], [0, 0, 1.35], 0.13),  # neck and head
    *[bar for s in (-1, 1) for bar in (
        ([s * 0.2, 0, 0.8], [s * 0.5, 0, 0.45], 0.09),  # upper arm
        ([s * 0.5, 0, 0.45], [s * 0.48, 0, -0.1], 0.08),  # forearm, along the trunk
        ([s * 0.13, 0, 0.0], [s * 0.25, 0, -0.9], 0.11),  # leg
        ([s * 0.25, 0, -0.9], [s * 0.25, -0.25, -0.9], 0.09),  # foot
    )],
]  # fmt: skip
FIGURE_CUTS = [
    ([0, 0, 0.35], [0, 0, 1]), ([0, 0, 1.05], [0, 0, 1]),
    *[cut for s in (-1, 1) for cut in (
        ([s * 0.36, 0, 0.62], [s * 0.3, 0, -0.35]), ([s * 0.49, 0, 0.2], [0, 0, -1]),
        ([s * 0.19, 0, -0.35], [s * 0.12, 0, -0.9]), ([s * 0.24, 0, -0.7], [0, 0, -1]),
    )],
]  # fmt: skip

QUADRUPED = [
    ([-0.7, 0, 0], [0.7, 0, 0], 0.26), ([-0.75, 0, 0.05], [-1.15, 0, 0.55], 0.13),
    ([-1.15, 0, 0.55], [-1.45, 0, 0.45], 0.1), ([0.8, 0, 0.1], [1.3, 0, -0.2], 0.06),
    *[([x, s * 0.16, -0.1], [x, s * 0.2, -0.95], 0.1) for x in (-0.6, 0.6) for s in (-1, 1)],
]  # fmt: skip
QUADRUPED_CUTS = [
    ([0, 0, 0], [1, 0, 0]), ([-0.95, 0, 0.3], [-0.4, 0, 0.5]), ([1.05, 0, -0.03], [0.5, 0, -0.3]),
    *[([x, s * 0.19, -0.55], [0, 0, -1]) for x in (-0.6, 0.6) for s in (-1, 1)],
]  # fmt: skip


@cache
def figure() -> PolygonMesh:
    """A trunk, a head, arms that hang beside it, legs with feet."""
    return grown(FIGURE)


@cache
def quadruped() -> PolygonMesh:
    """A trunk on four legs, neck and head, a tail."""
    return grown(QUADRUPED)


def grown(bars, spacing=0.045, blend=0.03) -> PolygonMesh:
    """The surface of round bars, ``(from, to, radius)`` each, that melt into each other."""
    ends = np.array([[one, two] for one, two, _ in bars], float)
    low, high = ends.min(axis=(0, 1)) - 0.45, ends.max(axis=(0, 1)) + 0.45
    axes = [np.arange(low[i], high[i], spacing) for i in range(3)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    total = 0.0
    for (one, two), (*_, radius) in zip(ends, bars, strict=True):
        along = np.clip((places - one) @ (two - one) / ((two - one) @ (two - one)), 0, 1)
        distance = np.linalg.norm(places - one - along[..., None] * (two - one), axis=-1)
        total = total + np.exp(-(distance - radius) / blend)
    points, triangles, _, _ = marching_cubes(-blend * np.log(total), 0.0)
    return PolygonMesh(points * spacing + low, triangles)
