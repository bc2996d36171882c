"""Bodies for the gallery, made on the spot: limbs of round cones that melt into each other."""

from __future__ import annotations

from functools import cache

import numpy as np
import pyvista

from pliant import PolygonMesh

# from and to, radii at either end; x to the right, y away from the viewer, z up
FIGURE = [
    ((0, 0, 0.95), (0, 0.02, 1.12), 0.145, 0.12), ((0, 0.02, 1.12), (0, 0, 1.38), 0.12, 0.155),
    ((0, 0, 1.4), (0, -0.01, 1.58), 0.06, 0.055), ((0, -0.02, 1.66), (0, 0, 1.74), 0.085, 0.095),
    *[limb for s in (-1, 1) for limb in (
        ((s * 0.15, 0.0, 1.42), (s * 0.42, 0.0, 1.22), 0.072, 0.048),
        ((s * 0.42, 0.0, 1.22), (s * 0.62, -0.05, 1.0), 0.05, 0.033),
        ((s * 0.62, -0.05, 1.0), (s * 0.68, -0.07, 0.92), 0.04, 0.034),
        ((s * 0.08, 0.0, 0.92), (s * 0.13, -0.01, 0.52), 0.105, 0.06),
        ((s * 0.13, -0.01, 0.52), (s * 0.16, 0.02, 0.1), 0.062, 0.04),
        ((s * 0.13, -0.035, 0.53), (s * 0.13, -0.035, 0.49), 0.05, 0.05),
        ((s * 0.15, 0.05, 0.36), (s * 0.15, 0.05, 0.3), 0.045, 0.035),
        ((s * 0.16, 0.02, 0.05), (s * 0.18, -0.14, 0.035), 0.05, 0.036),
    )],
]  # fmt: skip

# two lobes, and the vessel that leaves them, in decimetres
ORGAN = [
    ((-0.58, 0.0, 0.0), (-0.2, 0.06, 0.12), 0.36, 0.37), ((-0.2, 0.06, 0.12), (0.3, 0.0, 0.12), 0.36, 0.25),
    ((0.3, 0.0, 0.12), (0.78, -0.1, 0.05), 0.24, 0.1), ((-0.62, 0.05, -0.12), (-0.5, 0.1, -0.24), 0.3, 0.22),
    ((-0.05, -0.15, -0.1), (0.06, -0.2, -0.4), 0.08, 0.06), ((0.06, -0.2, -0.4), (0.22, -0.16, -0.6), 0.06, 0.055),
]  # fmt: skip


@cache
def figure(spacing: float = 0.025) -> PolygonMesh:
    """A human figure 1.8 high, arms half raised."""
    return _molten(FIGURE, spacing)


@cache
def horse(spacing: float = 0.03) -> tuple[PolygonMesh, np.ndarray]:
    """A horse about two long, and the vertices at its joints."""
    return _quadruped(0.95, (-0.86, 1.38), (-1.18, 1.22), 0.105, 0.0, spacing)


@cache
def camel(spacing: float = 0.035) -> tuple[PolygonMesh, np.ndarray]:
    """A camel about as long, of another number of vertices, and the vertices at the same joints."""
    return _quadruped(1.12, (-1.02, 1.5), (-1.3, 1.44), 0.085, 0.26, spacing)


@cache
def organ(spacing: float = 3.0) -> PolygonMesh:
    """An organ of two lobes and a vessel, about 200 mm long."""
    body = _molten(ORGAN, spacing / 100)
    return body.with_points(100 * body.points)


def _quadruped(height, poll, muzzle, neck, hump, spacing):
    """Facing -x: heights of the back, places of poll and muzzle, thickness of the neck, height of the hump."""
    chest, hips = np.array([-0.42, 0, height]), np.array([0.45, 0, height])
    poll, muzzle = np.array([poll[0], 0, poll[1]]), np.array([muzzle[0], 0, muzzle[1]])
    tail = [(0.66, 0, height + 0.02), (0.84, 0, height - 0.14), (0.9, 0, height - 0.4)]
    limbs = [
        (chest, hips, 0.23, 0.22), (chest, poll, 0.17, neck), (poll, muzzle, 0.1, 0.065),
        *[((0.03, 0, height + 0.04), (0.03, 0, height + 0.1 + hump), 0.2, 0.1) for _ in range(1 if hump else 0)],
        (_by(hips, [0.15, 0, 0]), tail[0], 0.1, 0.05),
        (tail[0], tail[1], 0.045, 0.04), (tail[1], tail[2], 0.045, 0.025),
        *[(_by(poll, [0.03, s * 0.05, 0.06]), _by(poll, [0.05, s * 0.07, 0.17]), 0.03, 0.012) for s in (-1, 1)],
    ]  # fmt: skip
    joints = [
        _by(chest, [-0.2, 0, -0.1]),
        _by(hips, [0.2, 0, 0.1]),
        (chest + poll) / 2,
        _by(poll, [0, 0, 0.1]),
        muzzle,
        *tail,
    ]
    joints += [np.array([x, s * 0.22, height]) for x in (-0.3, 0, 0.35) for s in (-1, 1)]
    joints += [np.array([0.03, 0, height + 0.2 + hump]), np.array([0, 0, height - 0.25])]
    for x, knee in ((-0.45, -0.02), (0.5, 0.08)):
        for s in (-0.13, 0.13):
            top, middle, foot = (x, s, height - 0.1), (x + knee, s, 0.45), (x, s, 0.06)
            limbs += [(top, middle, 0.13, 0.062), (middle, foot, 0.058, 0.04), (foot, (x - 0.05, s, 0.04), 0.05, 0.045)]
            side = np.array([0, np.sign(s) * 0.06, 0])
            joints += [np.array(p) + side for p in (top, middle, foot, (x, s, 0.27))]
            joints += [np.array([x + knee - 0.06, s, 0.45]), np.array([x - 0.1, s, 0.04]), np.array([x + 0.06, s, 0.1])]
    mesh = _molten(limbs, spacing)
    away = np.linalg.norm(mesh.points[None] - np.array(joints)[:, None], axis=2)
    return mesh, away.argmin(axis=1)


def _by(place, offset):
    return np.asarray(place) + offset


def _molten(limbs, spacing: float) -> PolygonMesh:
    """The surface of round cones, blended by a smooth minimum of their distances."""
    ends = np.array([[a, b] for a, b, _, _ in limbs], float)
    radii = np.array([[r, s] for _, _, r, s in limbs])
    wide = max(0.3, radii.max() + 0.05)
    low, high = ends.reshape(-1, 3).min(axis=0) - wide, ends.reshape(-1, 3).max(axis=0) + wide
    size = np.ceil((high - low) / spacing).astype(int) + 1
    grid = pyvista.ImageData(dimensions=size, spacing=(spacing,) * 3, origin=low)
    places, blend = np.asarray(grid.points), np.zeros(grid.n_points)
    for (a, b), (r, s) in zip(ends, radii, strict=True):
        part = np.clip((places - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        distance = np.linalg.norm(places - a - part[:, None] * (b - a), axis=1) - (r + part * (s - r))
        blend += np.exp(-np.clip(distance, -0.3, 0.6) / 0.018)
    surface = grid.contour([0.0], scalars=-0.018 * np.log(blend)).clean()
    return PolygonMesh(np.asarray(surface.points, float), surface.faces.reshape(-1, 4)[:, 1:])
