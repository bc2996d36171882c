"""Pressed flat, with and without its volume.

A lattice presses the ball in the middle from above and below. In the middle picture it simply loses what was pressed
away (blue); on the right `preserve_volume` corrects the control points that are free, by the smallest change along
each axis in turn, and the ball bulges instead (red). Its volume is that of the ball at rest, to the last digit: the
number is what is missing.
"""

from pathlib import Path

import numpy as np
from PIL import Image
from shapes import globe

import pliant as pl


def main(out: Path, size: tuple[int, int] = (600, 600)) -> float:
    ball = globe()
    lattice = pl.BSplineFFD.around(ball, shape=(5, 5, 5), margin=0.15)
    pressed = lattice.rest.copy()
    pressed[1:4, 1:4, :, 2] *= 0.35
    squeezed = lattice.moved(pressed)

    free = np.zeros(lattice.shape, bool)
    free[:, :, 1:4] = True  # the plates above and below stay where they are
    kept = pl.preserve_volume(squeezed, ball, free)

    look = {"show": ("mesh", "lattice"), "color": "volume ratio", "limits": (0.3, 1.7), "view": (1, -1.4, 0.5)}
    panels = [pl.render(ball, map_, legend=False, size=size, **look) for map_ in (lattice, squeezed, kept)]
    Image.fromarray(np.hstack(panels)).save(out / "volume_keeping.png", optimize=True)
    assert pl.volume(squeezed(ball)) < 0.8 * pl.volume(ball)
    return 1 - pl.volume(kept(ball)) / pl.volume(ball)
