"""Taper: an obelisk, and a profile of keys.

Sections grow or shrink along the axis. Left, a straight ramp; right, the same factor along a curve through keys,
joined without overshoot. The inverse is exact: the number is what going there and back leaves.
"""

from pathlib import Path

import numpy as np
from PIL import Image
from shapes import pillar

import pliant as pl


def main(out: Path, size: tuple[int, int] = (600, 900)) -> float:
    stone = pillar()
    obelisk = pl.Taper.around(stone, axis="z", factor=0.35)
    keys = [(0, 0), (0.2, 0.9), (0.5, 0.2), (0.8, 0.9), (1, -0.3)]
    turned = pl.Taper.around(stone, axis="z", factor=0.35, profile=keys)
    look = {"show": ("mesh",), "color": "texture", "view": (1, -1.6, 0.4), "size": size}
    Image.fromarray(np.hstack([pl.render(stone, t, **look) for t in (obelisk, turned)])).save(out / "taper.png")
    return float(max(np.abs(t.inverse(t(stone.points)) - stone.points).max() for t in (obelisk, turned)))
