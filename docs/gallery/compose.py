"""Barr's hat: bend, then twist.

Deformers composed are a deformer, with a Jacobian, an inverse and the controls of both. With one of them at rest the
other is left, exactly: the number counts the coordinates that differ.
"""

from pathlib import Path

import numpy as np
from shapes import pillar

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    felt = pl.Flare.around(block := pillar(), axis="z", start=1.5, end=0.15)(block)
    bend = pl.Bend.around(felt, axis="y", normal="x", angle=np.pi / 3)
    twist = pl.Twist.around(felt, axis="z", angle=1.5 * np.pi)
    hat = pl.compose(bend, twist)
    pl.render(felt, hat, out / "compose.png", color="texture", show=("mesh",), view=(1, -1.4, 0.5), size=size)
    muted = hat.moved(np.concatenate([bend.controls, twist.rest]))
    return float((muted(felt.points) != bend(felt.points)).sum())
