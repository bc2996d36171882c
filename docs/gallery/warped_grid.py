"""How space is warped: a regular grid, before and after.

The oldest picture of a deformation: the lines of a regular grid, carried along. They are divided as finely as their
bends ask for, and can be saved as VTK polydata for other programs.
"""

from pathlib import Path

import pliant as pl
from pliant import examples


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    vase = examples.vase()
    lattice = pl.BSplineFFD.around(vase, shape=(5, 5, 7), margin=0.1)
    dancing = lattice.moved(examples.sway(lattice.rest, turn=1.0))

    pl.render(
        vase, dancing, out / "warped_grid.png", show=("mesh", "grid"), color="z", view=(1.0, -0.9, 0.5), size=size
    )
    grid = pl.field_grid(dancing, vase.bounds, spacing=vase.diagonal / 10)
    grid.save(out / "grid.vtp")
    return float(grid.magnitude.max() / vase.diagonal)
