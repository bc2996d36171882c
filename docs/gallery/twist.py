"""Twist: a pillar like a stick of barley sugar.

Barr's global deformation turns each section about the axis; the profile "smooth" lets the ends stand level. Volume is
kept at every point, exactly: the number is how far det J strays from one.
"""

from pathlib import Path

import numpy as np
from shapes import pillar

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    stick = pillar()
    twist = pl.Twist.around(stick, axis="z", angle=1.5 * np.pi, profile="smooth")
    pl.render(stick, twist, out / "twist.png", color="texture", show=("mesh",), view=(1, -1.4, 0.5), size=size)
    return float(np.abs(pl.volume_ratio(twist, stick) - 1).max())
