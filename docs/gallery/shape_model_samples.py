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
    row = [
        pl.render(model.reference.with_points(points), size=panel, view="top", up="y")
        for points in model.sample(5, seed=4)
    ]
    plot = scree(model.variances / model.variances.sum(), pl.compactness(model), (5 * panel[0], size[1] - panel[1]))
    Image.fromarray(np.vstack([np.hstack(row), plot])).save(out / "shape_model_samples.png")
    return float(pl.compactness(model)[19])  # the part of the variance in the first twenty fields


def scree(shares: np.ndarray, together: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Bars and a line, drawn twice as large and averaged."""
    width, height = 2 * size[0], 2 * size[1]
    image = Image.new("RGB", (width, height), "white")
    draw = ImageDraw.Draw(image)
    left, right, top, bottom = 120, width - 120, 60, height - 80
    step, rise = (right - left) / len(shares), bottom - top
    for number, share in enumerate(shares):
        x = left + number * step
        draw.rectangle([x + 0.15 * step, bottom - rise * share / shares[0], x + 0.85 * step, bottom], fill="#7fa7d1")
    line = [(left + (number + 0.5) * step, bottom - rise * part) for number, part in enumerate(together)]
    draw.line(line, fill="#c8553d", width=6, joint="curve")
    for x, y in line:
        draw.ellipse([x - 9, y - 9, x + 9, y + 9], fill="#c8553d")
    draw.line([(left, bottom), (right, bottom)], fill="#444444", width=3)
    return np.asarray(image.resize(size, Image.Resampling.LANCZOS))
