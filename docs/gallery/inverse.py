"""There and back: a map and its inverse.

A registration says where a target's points come from; who wants to move points needs the inverse. Left: the knot and
its lattice. Middle: the knot under the map, with the warped grid. Right: the same knot under the inverse, a deformer as
any other. The number is how far a point is from home after both.
"""

from pathlib import Path

import numpy as np
from PIL import Image
from shapes import trefoil

import pliant as pl
from pliant.space.inverse import Inverse


def main(out: Path, size: tuple[int, int] = (600, 500)) -> float:
    knot = trefoil()
    lattice = pl.BSplineFFD.around(knot, shape=(5, 5, 4), margin=0.1)
    controls = lattice.rest.copy()
    turn = pl.Twist.around(knot, angle=1.1)
    controls[:] = turn(controls.reshape(-1, 3)).reshape(controls.shape)
    there = lattice.moved(controls)
    back = Inverse(there)
    look = {"color": "texture", "view": (0.7, -1.1, 1.0), "size": size}
    panels = [
        pl.render(knot, lattice, **look),
        pl.render(knot, there, show=("mesh", "grid"), **look),
        pl.render(knot, back, show=("mesh", "grid"), **look),
    ]
    Image.fromarray(np.hstack(panels)).save(out / "inverse.png", optimize=True)
    return float(np.abs(back(there(knot)).points - knot.points).max() / knot.diagonal)
