"""Landmarks of a shape model.

Five points of a knot are seen where another shape of the model has them. From left to right: one, three, five of them
are known. The shape becomes the most likely one, and the colour, how far each point may still be away, fades around
what is known.
"""

from pathlib import Path

import numpy as np
from PIL import Image
from shapes import trefoil

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1500, 560)) -> float:
    knot = trefoil(along=200, around=20)
    kernel = pl.GaussianKernel(sigma=0.35 * knot.diagonal, scale=0.06 * knot.diagonal)
    model = pl.ShapeModel.from_kernel(knot, kernel, rank=40)
    truth = model.sample(1, seed=8)[0]
    seen = np.linspace(0, len(truth), 5, endpoint=False).astype(int)[[0, 2, 4, 1, 3]]
    row, missed = [], []
    for count in (1, 3, 5):
        known = seen[:count]
        shape = pl.ConditionedModel(model, vertices=known, positions=truth[known])
        image = pl.render(
            shape(knot),
            color=shape.posterior().uncertainty,
            limits=(0.0, float(model.uncertainty.max())),
            legend=count == 5,
            size=(size[0] // 3, size[1]),
            view="top",
            up="y",
        )
        row.append(image)
        missed.append(np.linalg.norm(shape.points - truth, axis=1).mean() / knot.diagonal)
    Image.fromarray(np.hstack(row)).save(out / "model_landmarks.png")
    return float(missed[-1] / missed[0])  # how near five landmarks come, against one
