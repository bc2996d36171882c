"""Direct manipulation: take a vase by its lip.

Two points of the lip are pulled, the foot is pinned, and of all moves of the lattice's control points that do this
the least one is found. The number is how far the pulled points miss their targets, in diagonals.
"""

from pathlib import Path

import numpy as np

import pliant as pl
from pliant import examples


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    vase = examples.vase()
    lattice = pl.BSplineFFD.around(vase, shape=(7, 7, 7), margin=0.05)
    height = vase.points[:, 2]
    lip = vase.points[height > height.max() - 1e-6 * vase.diagonal]
    held = lip[[np.argmax(lip[:, 0]), np.argmin(lip[:, 0])]]
    foot = vase.points[height < height.min() + 1e-6 * vase.diagonal]
    goals = held + vase.diagonal * np.array([[0.22, 0, 0.1], [0.05, 0, -0.08]])
    poured = pl.pull(lattice, held, goals, pins=foot[::8])
    pl.render(vase, poured, out / "pull.png", show=("mesh",), color="texture", view=(0.4, -1.5, 0.5), size=size)
    return float(np.abs(poured(held) - goals).max() / vase.diagonal)
