"""A shape and stacks on it that many tests of scenes use, made on the spot."""

from __future__ import annotations

import numpy as np

import pliant as pl


def tube(rings: int = 16, around: int = 10) -> pl.PolygonMesh:
    """A tube of quadrangles along z with a polygon at either end."""
    height, angle = np.linspace(0, 4, rings), np.linspace(0, 2 * np.pi, around, endpoint=False)
    width = 0.5 + 0.15 * np.sin(2 * height)[:, None] * (1 + 0.2 * np.cos(3 * angle))
    points = np.stack(
        [width * np.cos(angle), width * np.sin(angle), np.broadcast_to(height[:, None], width.shape)], axis=-1
    ).reshape(-1, 3)
    faces = [list(range(around))[::-1], list(range((rings - 1) * around, rings * around))]
    for r in range(rings - 1):
        for s in range(around):
            a, b = r * around + s, r * around + (s + 1) % around
            faces.append([a, b, b + around, a + around])
    return pl.PolygonMesh(points, faces)


MESH = tube()
HEIGHT = MESH.points[:, 2]
MASK = np.clip(HEIGHT / 4, 0, 1)
ROI, HANDLE = np.flatnonzero(HEIGHT > 1.2), np.flatnonzero(HEIGHT > 3.4)
GOAL = (MESH.points[HANDLE] - [0, 0, 1.2]) @ pl.Affine.rotation("x", 0.5).linear.T + [0.1, 0, 1.3]


def lattice(seed: int = 0, size: float = 0.08) -> pl.BSplineFFD:
    """A B-spline lattice around the tube, its control points moved at random."""
    at_rest = pl.BSplineFFD.around(MESH, shape=(4, 4, 5))
    return at_rest.moved(at_rest.rest + np.random.default_rng(seed).normal(size=at_rest.rest.shape) * size)


def space_stack() -> pl.Stack:
    """Maps of space only, one at half strength, one masked."""
    return pl.Stack(
        [
            pl.Layer("warp", lattice()),
            pl.Layer("twist", pl.Twist.around(MESH, angle=0.7), envelope=0.5),
            pl.Layer("taper", pl.Taper.around(MESH, factor=0.6), mask=MASK, invert=True),
        ]
    )


def mixed_stack() -> pl.Stack:
    """An edit of the surface between two maps of space."""
    return pl.Stack(
        [
            pl.Layer("warp", lattice()),
            pl.Layer("edit", pl.LaplacianEdit(ROI, HANDLE).moved(GOAL), mask=MASK),
            pl.Layer("twist", pl.Twist.around(MESH, angle=0.5), mask=MASK),
        ]
    )
