"""A deformation in a file, and back.

Lattices are exchanged as zxhproj `.FFD` files. What a file cannot hold is in the report that writing returns, never
silent; read again, it is the same map up to the digits that the file keeps.
"""

from pathlib import Path

import numpy as np

import pliant as pl
from pliant import examples


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    vase = examples.vase()
    lattice = pl.BSplineFFD.around(vase, shape=(5, 5, 8), margin=0.05)
    dancing = lattice.moved(examples.sway(lattice.rest))

    pl.write_transform(dancing, out / "dance.FFD")
    again = pl.read_transform(out / "dance.FFD")

    pl.render(vase, again, out / "read_write_ffd.png", color="texture", show=("mesh", "grid"), size=size)
    return float(np.abs(again(vase.points) - dancing(vase.points)).max() / vase.diagonal)  # 0, but for digits
