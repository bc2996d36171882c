"""A plane becomes a surface, and carries what stands on it.

The control points of a Bézier patch lie in a plane; where they go, the plane follows as a Bézier surface. Points off
the plane keep their distance from it along its normal, so that studs stay upright on a saddle. The number is the
largest error of those distances.
"""

from pathlib import Path

import numpy as np

import pliant as pl
from pliant.mesh import CornerValues


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    n = 241
    u, v = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    place = np.hypot(np.mod(8 * u, 1) - 0.5, np.mod(8 * v, 1) - 0.5)
    studs = 0.03 * np.clip((0.33 - place) / 0.06, 0, 1)
    points = np.stack([u, v, studs], axis=-1).reshape(-1, 3)
    corner = np.arange(n * n).reshape(n, n)
    quads = np.stack([corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]], axis=-1).reshape(-1, 4)
    sheet = pl.PolygonMesh(points, quads, uvs=CornerValues(points[:, :2] / 2, quads.reshape(-1)))

    flat = np.zeros((4, 5, 1, 3))
    patch = pl.BezierPatchFFD(displacements=flat, origin=np.zeros(3), edges=np.eye(3)[:, :2])
    lift = np.array([[0.55, 0.0, -0.35, 0.0, 0.6], [0.1, 0.5, 0.0, 0.5, 0.1], [-0.3, 0.6, 0.9, 0.6, -0.3]])
    saddle = patch.moved(patch.rest + np.vstack([lift, lift[:1]])[:, :, None, None] * [0, 0, 0.7])

    pl.render(sheet, saddle, out / "bezier_patch.png", color="texture", view=(1.0, -1.4, 1.1), size=size)
    foot = saddle(points * [1, 1, 0])
    return float(np.abs(np.linalg.norm(saddle(points) - foot, axis=1) - points[:, 2]).max())  # 0
