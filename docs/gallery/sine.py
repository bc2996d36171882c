"""Sine: a pillar sways.

Sections slide sideways in a wave along the axis, under a profile that holds both ends. As the phase grows the wave
travels. The number is how far det J strays from one: sliding keeps volume.
"""

from pathlib import Path

import numpy as np
from shapes import pillar

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    post = pillar(width=0.7)
    sine = pl.Sine.around(post, axis="z", normal="x", amplitude=0.3, waves=2, profile="bump")
    pl.render(post, sine, out / "sine.png", color="texture", show=("mesh",), view=(0.5, -1.5, 0.4), size=size)
    return float(np.abs(pl.volume_ratio(sine, post) - 1).max())
