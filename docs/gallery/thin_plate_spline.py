"""Thin-plate spline: fourteen landmarks turn a shell.

Landmarks go where they are put, and all space follows, bending as little as it can: the arrows show how. The number
is how far the landmarks miss their targets, in diagonals.
"""

from pathlib import Path

import numpy as np
from shapes import shell

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    sea_shell = shell()
    landmarks = sea_shell.points[:: len(sea_shell.points) // 13]
    lean = pl.Bend.around(sea_shell, axis="y", normal="x", angle=1.0)
    targets = lean(landmarks)
    warp = pl.ThinPlateSpline(landmarks, targets)
    pl.render(sea_shell, warp, out / "thin_plate_spline.png", show=("mesh", "arrows"), color="displacement", size=size)
    return float(np.abs(warp(landmarks) - targets).max() / sea_shell.diagonal)
