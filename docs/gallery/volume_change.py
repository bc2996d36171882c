"""Where the material swells and where it is squeezed.

The determinant of the Jacobian is the local volume ratio: one where volume is kept (white), above one where space
swells (red), below where it is squeezed (blue), never below zero unless the map folds. The number is the volume of
the deformed knot over that of the knot at rest.
"""

from pathlib import Path

from shapes import trefoil

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    knot = trefoil()
    lattice = pl.BSplineFFD.around(knot, shape=(6, 6, 4), margin=0.1)
    controls = lattice.rest.copy()
    from_center = controls - knot.center
    controls[:3] += 0.16 * from_center[:3]  # one half swells
    controls[4:] -= 0.2 * from_center[4:]  # the other shrinks
    changed = lattice.moved(controls)

    pl.render(knot, changed, out / "volume_change.png", show=("mesh",), color="volume ratio", size=size)
    return pl.volume(changed(knot)) / pl.volume(knot)
