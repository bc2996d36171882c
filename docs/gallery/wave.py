"""Wave: a stone fell into this pond.

Ripples around an axis; as the phase grows they travel outwards. A profile lets them fade with the distance. The
number is what the exact inverse leaves of them.
"""

from pathlib import Path

import numpy as np
from shapes import pillar

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    pond = pillar(width=8, height=0.6, cells=160)
    wave = pl.Wave.around(pond, axis="z", amplitude=0.35, waves=5, profile=[(0, 1), (0.4, 0.35), (1, 0)])
    pl.render(pond, wave, out / "wave.png", show=("mesh",), color="z", legend=False, view=(1, -1.2, 1.1), size=size)
    flat = wave.inverse(wave(pond.points))
    return float(np.abs(flat - pond.points).max())
