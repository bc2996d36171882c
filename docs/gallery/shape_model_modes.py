"""The modes of a shape model.

Each row is one field of the model, from three standard deviations below the mean to three above it. Strong fields move
the whole shape smoothly, weaker ones bend it.
"""

from pathlib import Path

import numpy as np
from PIL import Image
from shapes import trefoil

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1500, 900)) -> float:
    knot = trefoil(along=200, around=20)
    kernel = pl.GaussianKernel(sigma=0.4 * knot.diagonal, scale=0.06 * knot.diagonal)
    model = pl.ShapeModel.from_kernel(knot, kernel, rank=30)
    rows = []
    for mode in (2, 12):  # coefficient 3 j + c moves coordinate c along field j
        row = []
        for level in (-3, 0, 3):
            coefficients = np.zeros(model.count)
            coefficients[mode] = level
            shape = model.mesh(coefficients)
            row.append(pl.render(shape, size=(size[0] // 3, size[1] // 2), view="top", up="y"))
        rows.append(np.hstack(row))
    Image.fromarray(np.vstack(rows)).save(out / "shape_model_modes.png")
    return float(pl.compactness(model)[9])  # the part of the variance in the first ten fields
