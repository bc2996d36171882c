"""The picture at the top of the README: a vase in its lattice, both swaying, and how space is warped.

Run it to draw `docs/pictures/hero.png` anew.
"""

from pathlib import Path

import numpy as np
from PIL import Image

import pliant as pl
from pliant import examples


def main(out: Path, size: tuple[int, int] = (520, 600)) -> float:
    vase = examples.vase()
    lattice = pl.BSplineFFD.around(vase, shape=(4, 4, 6), margin=0.04)
    swaying = lattice.moved(examples.sway(lattice.rest, turn=1.2, lean=0.2))
    panels = [
        pl.render(vase, lattice, color="texture", size=size),
        pl.render(vase, swaying, color="texture", size=size),
        pl.render(vase, swaying, color="displacement", show=("mesh", "grid"), legend=False, size=size),
    ]
    Image.fromarray(np.hstack(panels)).save(out / "hero.png", optimize=True)
    return float(len(panels))


if __name__ == "__main__":
    main(Path(__file__).parents[1] / "pictures")
