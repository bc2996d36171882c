"""A lattice around an axis twists a vase into petals.

Extended free-form deformation takes lattices of other shapes than boxes: here a cylinder, whose control points on the
axis are shared by all its patches. Each point knows its parameters in the lattice at rest, found by Newton's
method; the number is the largest error with which the lattice at rest gives the points back.
"""

from pathlib import Path

import numpy as np

import pliant as pl
from pliant.examples import vase


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    pot = vase()
    lattice = pl.ExtendedFFD.cylinder(pot, axis="z", shape=(10, 4, 7))

    low, high = pot.bounds
    height = (lattice.rest[:, 2] - low[2]) / (high[2] - low[2])
    angle = np.arctan2(lattice.rest[:, 1], lattice.rest[:, 0])
    swell = 1 + 0.45 * np.cos(5 * angle) * np.clip(height, 0, 1) ** 0.7  # five petals, wider towards the lip
    turn = 1.3 * height
    x, y = (swell[:, None] * lattice.rest[:, :2]).T
    controls = np.stack([np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y], axis=1)
    twisted = lattice.moved(np.column_stack([controls, lattice.rest[:, 2]]))

    pl.render(pot, twisted, out / "extended_ffd.png", color="texture", view=(0.6, -1.2, 1.0), size=size)
    weights = lattice.bind(pot).matrix()
    return float(np.abs(weights @ lattice.rest - pot.points).max() / pot.diagonal)  # 0
