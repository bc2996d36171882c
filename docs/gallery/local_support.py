"""Bind once, move often: a drag touches only what it must.

Binding sorts the points into the lattice's cells. When one control point moves, only the points of its 4 × 4 × 4
cells are recomputed; `drag.update` says which. The picture shows how far the points went, the number is the part
of the points that were touched.
"""

from pathlib import Path

import numpy as np
from shapes import trefoil

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    knot = trefoil()
    lattice = pl.BSplineFFD.around(knot, shape=(10, 10, 6), margin=0.05)
    bound = lattice.bind(knot)  # the work that does not depend on where the controls are

    controls = lattice.rest.copy()
    drag = bound.drag(controls)
    for _ in range(12):  # the mouse moves
        controls[7, 3, 4] += [0.18, -0.12, 0.16]
        touched = drag.update(controls, changed=[(7, 3, 4)])
    assert np.array_equal(drag.points, bound.deform(controls)) or np.allclose(drag.points, bound.deform(controls))

    pl.render(knot, lattice.moved(controls), out / "local_support.png", show=("mesh",), color="displacement", size=size)
    return len(touched) / len(knot.points)
