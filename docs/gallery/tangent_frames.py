"""Barr's local deformation: a pillar grows like a tendril.

Along the axis the tangent turns a little more in each segment, and space follows; positions are its integral, in
closed form. The number is the length of the new axis over the old one: segments grow by a tenth.
"""

from pathlib import Path

import numpy as np
from shapes import pillar

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    stem = pillar(width=0.5, height=8)
    rates = np.zeros((16, 4))  # turns about x, y and the axis in radians, and growth, a segment
    rates[:, 1] = np.linspace(0, 0.9, 16)
    rates[:, 2] = 0.12
    rates[:, 3] = 0.1
    tendril = pl.TangentFrames.around(stem, axis="z", rates=rates)
    pl.render(
        stem, tendril, out / "tangent_frames.png", color="texture", show=("mesh",), view=(0.3, -1.5, 0.4), size=size
    )
    axis = tendril(np.linspace([0, 0, 0], [0, 0, 8], 4001))
    return float(np.linalg.norm(np.diff(axis, axis=0), axis=1).sum() / 8)
