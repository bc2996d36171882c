"""Where everything goes: displacements as arrows.

Arrows stand on a regular grid, drawn to scale where that is legible, and the surface takes the colour of how far it
moved. The longest displacement is that of the control points that were moved together.
"""

from pathlib import Path

import numpy as np
from shapes import shell

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    sea_shell = shell()
    lattice = pl.BSplineFFD.around(sea_shell, shape=(6, 6, 6), margin=0.1)
    controls = lattice.rest.copy()
    controls[:, :, 4:] += [0.9, 0.0, 0.5]  # two whole layers: the top of the shape moves with them
    leaning = lattice.moved(controls)

    pl.render(
        sea_shell, leaning, out / "displacement_arrows.png", show=("mesh", "arrows"), color="displacement", size=size
    )
    field = pl.arrows(leaning, lattice_box(lattice), spacing=sea_shell.diagonal / 12)
    return float(field.magnitude.max() / np.linalg.norm([0.9, 0.0, 0.5]))  # at most 1


def lattice_box(lattice: pl.BSplineFFD) -> tuple[np.ndarray, np.ndarray]:
    return lattice.rest[0, 0, 0], lattice.rest[-1, -1, -1]
