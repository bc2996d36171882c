"""A Bézier lattice makes a vase dance.

The free-form deformation of Sederberg & Parry: one hyperpatch of Bernstein polynomials, of any degree. Every control
point reaches the whole shape, which suits gestures: bend, twist, swell. Polygons stay polygons and the texture
stays where it was painted.
"""

from pathlib import Path

import pliant as pl
from pliant import examples, volume_ratio


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    vase = examples.vase()
    lattice = pl.BezierFFD.around(vase, shape=(3, 3, 7))
    dancing = lattice.moved(examples.sway(lattice.rest))

    pl.render(vase, dancing, out / "bezier_ffd.png", color="texture", size=size)
    return float(volume_ratio(dancing, vase).min())  # above zero: nothing folds
