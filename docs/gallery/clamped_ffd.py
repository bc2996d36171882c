"""A box of clamped B-splines, as aerodynamic shape optimisation moves it.

The outermost control points lie on the box, and a point stays where it is until a control point near it moves. Such
boxes are exchanged as Plot3D files. The number is how far the vase went, as part of its size.
"""

from pathlib import Path

import numpy as np

import pliant as pl
from pliant import examples


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    vase = examples.vase()
    box = pl.ClampedFFD.around(vase, shape=(5, 5, 9), margin=0.02)

    controls = box.rest.copy()
    controls[1:4, 1:4, 4] += (controls[1:4, 1:4, 4] - vase.center) * [1.2, 1.2, 0]  # a belly
    bellied = box.moved(controls)

    pl.write_transform(bellied, out / "belly.xyz")
    pl.render(vase, bellied, out / "clamped_ffd.png", show=("mesh", "lattice"), color="displacement", size=size)
    return float(np.linalg.norm(bellied(vase.points) - vase.points, axis=1).max() / vase.diagonal)
