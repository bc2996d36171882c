"""Radial basis warp: pulled at three places, and left alone elsewhere.

Wendland's function ends at a distance: landmarks move what is near them. The number is the part of the points that
keep their place, to the last bit.
"""

from pathlib import Path

import numpy as np
from shapes import trefoil

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    knot = trefoil()
    landmarks = knot.points[[int(part * len(knot.points)) for part in (0.17, 0.5, 0.83)]]
    outwards = landmarks - knot.center
    targets = landmarks + 1.2 * outwards / np.linalg.norm(outwards, axis=1, keepdims=True)
    warp = pl.RadialBasisWarp(landmarks, targets, support=2.0)
    pl.render(
        knot,
        warp,
        out / "radial_basis_warp.png",
        show=("mesh",),
        color="displacement",
        view=(0.5, -0.8, 1.2),
        size=size,
    )
    return float((warp(knot.points) == knot.points).all(axis=1).mean())
