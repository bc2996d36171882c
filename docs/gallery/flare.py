"""Flare: a pillar with feet, and a waist.

Both ends open, the middle draws in: scales at the two bounds, and a bulge between them, negative here. The number is
the least volume ratio, the square of the narrowest scale.
"""

from pathlib import Path

from shapes import pillar

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    post = pillar()
    flare = pl.Flare.around(post, axis="z", start=1.6, end=1.3, bulge=-0.95)
    pl.render(post, flare, out / "flare.png", color="texture", show=("mesh",), view=(1, -1.4, 0.4), size=size)
    return float(pl.volume_ratio(flare, post).min())
