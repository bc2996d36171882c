"""Squash and stretch, as animators do it.

What the axis gains the sections lose: det J is one at every point. The number is the larger change of the pillar's
volume, in parts; its flat faces leave a little, the maps nothing.
"""

from pathlib import Path

import numpy as np
from PIL import Image
from shapes import pillar

import pliant as pl


def main(out: Path, size: tuple[int, int] = (400, 900)) -> float:
    post = pillar(width=1.4, height=2.4)
    squashes = [pl.Squash.around(post, axis="z", factor=f, origin=(0, 0, 0)) for f in (0.6, 1.0, 1.5)]
    look = {"show": ("mesh",), "color": "texture", "view": (1, -1.6, 0.4), "size": size}
    Image.fromarray(np.hstack([pl.render(post, s, **look) for s in squashes])).save(out / "squash.png")
    return float(max(abs(pl.volume(s(post)) / pl.volume(post) - 1) for s in squashes))
