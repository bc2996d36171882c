"""A deformation that folds, and the same as far as it goes without.

The left sheet is pulled over itself: `certify` finds the point where it folds most, and proves that det J is nowhere
less than the bound it gives. `limit_to_fold_free` scales the displacements to the last step before the first fold, on
the right: a proof for every point, not for samples. The number is that step.
"""

from pathlib import Path

import numpy as np
from PIL import Image

import pliant as pl


def sheet(cells: int = 64) -> pl.PolygonMesh:
    """A square of quadrangles, 2 x 2."""
    u, v = np.meshgrid(np.linspace(-1, 1, cells + 1), np.linspace(-1, 1, cells + 1), indexing="ij")
    corner = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).reshape(-1, 1)
    faces = corner + np.array([0, cells + 1, cells + 2, 1])
    return pl.PolygonMesh(np.stack([u, v, 0 * u], axis=-1).reshape(-1, 3), faces)


def main(out: Path, size: tuple[int, int] = (900, 700)) -> float:
    square = sheet()
    lattice = pl.BSplineFFD.around(square, shape=(9, 9, 1))
    pulled = lattice.rest.copy()
    pulled[2:5, 3:6, 0] += [0.8, 0.3, 0.25]  # nine control points pass over their neighbours
    folding = lattice.moved(pulled)
    proof = pl.certify(folding)
    assert proof.status == "folds"

    safe = pl.limit_to_fold_free(folding, margin=0.05)
    look = {"color": "volume ratio", "limits": (-1.5, 3.5), "view": (0.9, -0.6, 1.1), "size": size}
    panels = [pl.render(square, map_, show=("mesh", "edges"), **look) for map_ in (folding, safe)]
    Image.fromarray(np.hstack(panels)).save(out / "fold_certificate.png", optimize=True)
    return float(np.abs(safe.displacements).max() / np.abs(folding.displacements).max())
