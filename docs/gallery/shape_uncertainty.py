"""What is not known of a shape.

A model that has seen five points of a shape is sure about them, less so nearby, and unsure far away. The colours are
the standard deviations of the posterior: how far each vertex may still stray.
"""

from pathlib import Path

import numpy as np
from shapes import trefoil

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    knot = trefoil(along=200, around=20)
    kernel = pl.GaussianKernel(sigma=0.25 * knot.diagonal, scale=0.05 * knot.diagonal)
    model = pl.ShapeModel.from_kernel(knot, kernel, rank=80)
    shape = model.sample(1, seed=4)[0]
    seen = np.array([0, 420, 800, 1300, 2600])
    posterior = model.posterior(seen, shape[seen], noise=1e-3 * knot.diagonal)
    pl.render(posterior.mesh(), path=out / "shape_uncertainty.png", color=posterior.uncertainty, size=size, view="top")
    missed = np.linalg.norm(posterior.mean[seen] - shape[seen], axis=1).max()
    return float(missed / knot.diagonal)  # the mean passes through what was seen, but for the noise
