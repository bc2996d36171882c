"""Samples of a shape model in a row, and its scree plot.

Random shapes differ as the kernel says: smoothly, and by its scale. The bars below are the variances of the fields,
the strongest first; the line is the part that the first fields hold together.
"""

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw
from shapes import trefoil

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1500, 800)) -> float:
    knot = trefoil(along=200, around=20)
    kernel = pl.GaussianKernel(sigma=0.35 * knot.diagonal, scale=0.06 * knot.diagonal)
    model = pl.ShapeModel.from_kernel(knot, kernel, rank=40)
    panel = (size[0] // 5, size[0] // 5)
    shapes = [model.reference.with_points(points) for points in model.sample(5, seed=4)]
    row = [pl.render(shape, size=panel, view="top", up="y") for shape in shapes]
    plot = scree(model.variances / model.variances.sum(), pl.compactness(model), (5 * panel[0], size[1] - panel[1]))
    Image.fromarray(np.vstack([np.hstack(row), plot])).save(out / "shape_model_samples.png")
    return float(pl.compactness(model)[19])  # the part of the variance in the first twenty fields


def scree(shares: np.ndarray, together: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Bars and a line, drawn twice as large and averaged."""
    image = Image.new("RGB", (2 * size[0], 2 * size[1]), "white")
    width, height = image.size
    draw = ImageDraw.Draw(image)
    left, bottom, rise = 0.04 * width, 0.92 * height, 0.86 * height
    step = 0.92 * width / len(shares)
    for number, share in enumerate(shares):
        x = left + number * step
        draw.rectangle([x + 0.15 * step, bottom - rise * share / shares[0], x + 0.85 * step, bottom], fill="#7fa7d1")
    line = [(left + (number + 0.5) * step, bottom - rise * part) for number, part in enumerate(together)]
    draw.line(line, fill="#c8553d", width=6, joint="curve")
    draw.line([(left, bottom), (width - left, bottom)], fill="#444444", width=3)
    return np.asarray(image.resize(size, Image.Resampling.LANCZOS))
