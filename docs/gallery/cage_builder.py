"""A cage from cuts: planes across the limbs become rings, and rings a cage.

`CageBuilder` takes planes; what lies between two cuts is linked, where more meet there is a branch, and ends are
capped. Few rings in the right places give a cage that is easy to pose: each limb has its own. The number is the cage's
Euler characteristic.
"""

from pathlib import Path

import numpy as np
from bodies import figure
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (700, 900)) -> float:
    body = figure()
    builder = pl.CageBuilder(body, sides=6, margin=0.008)
    for height in (1.03, 1.2):
        builder = builder.cut([0, 0, height], [0, 0, 1])
    builder = builder.cut([0, 0, 1.53], [0, 0, 1])
    for side in (-1, 1):
        for x, z, slope in ((0.28, 1.33, -0.75), (0.42, 1.22, -0.9), (0.6, 1.02, -1.0)):
            builder = builder.cut([side * x, -0.01, z], [side * 1.0, 0, slope])
        for x, z in ((0.12, 0.62), (0.14, 0.42), (0.155, 0.2)):
            builder = builder.cut([side * x, 0, z], [side * 0.2, 0, -1])
    rough, cage = builder.rough(), builder.build(rounds=2)
    assert pl.check_cage(cage, body).ok
    panels = [
        pl.render(body, pl.Cage(each), show=("mesh", "lattice"), view=(0.3, -1.0, 0.2), size=size)
        for each in (rough, cage)
    ]
    Image.fromarray(np.hstack(panels)).save(out / "cage_builder.png", optimize=True)
    return float(len(cage.points) - len(cage.edges) + len(cage.faces))
