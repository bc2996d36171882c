"""What a registration did to an organ, and how sure one can be.

Left: an organ under the B-spline transform that a registration wrote, coloured by the volume ratio det J, with the
warped grid. Right: a shape model that has seen the left half of a patient's organ; colours tell the standard deviation
of what it has not seen. The number is the certified lower bound of det J: positive, so that nothing folds.
"""

from pathlib import Path

import numpy as np
from bodies import organ
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (900, 700)) -> float:
    surface = organ()
    transform = pl.BSplineFFD.around(surface, shape=(6, 5, 5), margin=0.15)
    rng = np.random.default_rng(3)
    registered = transform.moved(transform.rest + rng.normal(scale=0.05 * surface.diagonal, size=transform.rest.shape))
    pl.write_transform(registered, out / "patient.tfm")  # LPS, as ITK has it
    registered = pl.read_transform(out / "patient.tfm")

    kernel = pl.GaussianKernel(sigma=0.35 * surface.diagonal, scale=0.06 * surface.diagonal)
    model = pl.ShapeModel.from_kernel(surface, kernel, rank=60)
    patient = model.sample(1, seed=2)[0]
    seen = np.flatnonzero(surface.points[:, 0] < surface.center[0] - 0.1 * surface.diagonal)[::12]
    posterior = model.posterior(seen, patient[seen], noise=0.5)
    look = {"size": size, "view": (0.3, -1.5, 0.5)}
    panels = [
        pl.render(surface, registered, show=("mesh", "grid"), color="volume ratio", **look),
        pl.render(posterior.mesh(), color=posterior.uncertainty, unit="mm", **look),
    ]
    Image.fromarray(np.hstack(panels)).save(out / "registered_organ.png", optimize=True)
    return pl.certify(registered).lower
