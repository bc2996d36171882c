"""A deformation as an image: dense displacements, and how many are enough.

Any map can be sampled on a grid, as registration programs exchange them. Linear interpolation between nodes is off by
the square of their distance, cubic interpolation by its fourth power. The number is how much less cubic is off here.
"""

from pathlib import Path

import numpy as np

import pliant as pl
from pliant import examples


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    vase = examples.vase()
    lattice = pl.BSplineFFD.around(vase, shape=(5, 5, 8), margin=0.1)
    dancing = lattice.moved(examples.sway(lattice.rest))

    room = pl.BSplineFFD.around(vase, margin=0.1).rest.reshape(-1, 3)  # what the grids cover: the vase and around it
    off = {}
    for interpolation in ("linear", "cubic"):
        grid = pl.to_grid(dancing, room, spacing=vase.diagonal / 24, interpolation=interpolation)
        off[interpolation] = np.abs(grid(vase.points) - dancing(vase.points)).max()

    pl.render(vase, grid, out / "displacement_grid.png", color="displacement", show=("mesh", "arrows"), size=size)
    return float(off["linear"] / off["cubic"])
