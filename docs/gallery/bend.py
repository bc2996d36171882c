"""Bend: a pillar becomes a horseshoe.

Between the bounds the axis becomes an arc, beyond them it goes on straight. Lengths along the middle stay: the number
is the length of the bent axis over that of the straight one.
"""

from pathlib import Path

import numpy as np
from shapes import pillar

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    post = pillar(width=0.8, height=6)
    bend = pl.Bend(axis="y", normal="x", angle=np.pi, bounds=(1.5, 4.5))  # along normal x axis: upwards
    pl.render(post, bend, out / "bend.png", color="texture", show=("mesh",), view=(0.3, -1.5, 0.5), size=size)
    axis = bend(np.linspace([0, 0, 0], [0, 0, 6], 2001))
    return float(np.linalg.norm(np.diff(axis, axis=0), axis=1).sum() / 6)
