"""Affine maps: what lies outside every lattice.

A rotation, a scaling and a shear, each about the vase's middle, drawn with the grid that they move. They are deformers
as any other, with twelve controls; put one after another they are one matrix. The number is the volume of the last.
"""

from pathlib import Path

import numpy as np
from PIL import Image

import pliant as pl
from pliant import examples


def main(out: Path, size: tuple[int, int] = (560, 600)) -> float:
    vase = examples.vase()
    sheared = pl.Affine.of([[1, 0, 0.6], [0, 1, 0], [0, 0, 1]], [-0.6 * vase.center[2], 0, 0])
    maps = [
        pl.Affine.rotation("y", np.radians(35), vase.center),
        pl.Affine.scaling([1.3, 0.6, 0.8], vase.center),
        sheared,
    ]
    look = {"color": "texture", "show": ("mesh", "grid"), "size": size}
    Image.fromarray(np.hstack([pl.render(vase, each, **look) for each in maps])).save(out / "affine.png", optimize=True)
    return pl.volume(maps[2](vase)) / pl.volume(vase)
