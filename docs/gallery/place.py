"""A moving tool: one bulge travels along a pillar.

The tool, a lattice with one swollen layer, knows nothing of the object; it is placed over it by an affine map, another
one in each picture. Where the tool has gone the pillar is as it was: the number counts the points that all four move.
"""

from pathlib import Path

import numpy as np
from PIL import Image
from shapes import pillar

import pliant as pl


def main(out: Path, size: tuple[int, int] = (300, 900)) -> float:
    post = pillar(width=0.8, height=5)
    lattice = pl.BSplineFFD.around(np.array([[-0.6, -0.6, -1.0], [0.6, 0.6, 1.0]]), shape=(4, 4, 9), edge="zero")
    swollen = lattice.rest.copy()
    swollen[:, :, 4] *= [2.2, 2.2, 1.0]
    tool = lattice.moved(swollen)
    placed = [pl.place(tool, pl.Affine.translation([0, 0, z])) for z in (0.8, 1.9, 3.0, 4.1)]
    look = {"show": ("mesh",), "color": "texture", "view": (1, -1.6, 0.3), "size": size}
    Image.fromarray(np.hstack([pl.render(post, p, **look) for p in placed])).save(out / "place.png")
    return float(np.all([(p(post.points) != post.points).any(axis=1) for p in placed], axis=0).sum())
