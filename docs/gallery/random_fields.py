"""Random fields of three kernels.

A Gaussian process is a random map of space, and no mesh is needed to draw one. The same kernel with three widths, side
by side: the larger sigma, the farther displacements agree, and the smoother the field.
"""

from pathlib import Path

import numpy as np
from PIL import Image
from shapes import trefoil

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1500, 500)) -> float:
    knot = trefoil(along=200, around=20)
    panels, bends = [], []
    for share in (0.12, 0.25, 0.5):
        kernel = pl.GaussianKernel(sigma=share * knot.diagonal, scale=0.04 * knot.diagonal)
        field = pl.GaussianProcess(kernel).sample(seed=3, domain=box(knot), rank=400, tolerance=0.05)
        panel = pl.render(
            knot, field, show=("mesh", "arrows"), color="displacement", legend=False, size=(size[0] // 3, size[1])
        )
        panels.append(panel)
        bends.append(np.abs(field.jacobian(knot.points[::50]) - np.eye(3)).mean())
    Image.fromarray(np.hstack(panels)).save(out / "random_fields.png")
    return float(bends[0] / bends[2])  # how much steeper the narrowest kernel's field is than the widest's


def box(mesh: pl.PolygonMesh) -> np.ndarray:
    low, high = mesh.bounds
    axes = [np.linspace(a, b, 9) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
