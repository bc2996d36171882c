"""A B-spline lattice bends a knot.

A uniform cubic B-spline lattice wraps the shape; the shape follows its control points, smoothly (C²) and
locally: a control point reaches only the 4 × 4 × 4 cells around it. The map is one of all space, so it has a
Jacobian and an inverse: the inverse brings every point of the knot back.
"""

from pathlib import Path

import numpy as np
from shapes import trefoil

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    knot = trefoil()
    lattice = pl.BSplineFFD.around(knot, shape=(4, 4, 3), margin=0.03)

    controls = lattice.rest.copy()
    controls[3] = (
        knot.center + (controls[3] - knot.center) * [1.0, 0.4, 1.3] + [0.5, 0.0, 2.6]
    )  # narrow and lift one end
    controls[0, :2] += [-0.8, -1.8, 0.6]  # pull a corner out of the other
    bent = lattice.moved(controls)

    pl.render(knot, bent, out / "bspline_ffd.png", color="texture", view=(0.7, -1.1, 1.0), size=size)
    returned = bent.inverse(bent(knot.points))
    return float(np.abs(returned - knot.points).max() / knot.diagonal)  # 0
