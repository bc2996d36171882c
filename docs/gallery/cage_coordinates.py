"""Three coordinates, one cage: what a bar does when its cage is bent.

From left to right mean value, harmonic and Green coordinates. The first two follow the cage exactly, and shear what is
on the bar; Green coordinates give up meeting the cage, and keep shapes: small squares stay squares. The number is the
shear that Green coordinates leave, as a part of that of mean values.
"""

from pathlib import Path

import numpy as np
from PIL import Image
from shapes import pillar

import pliant as pl


def main(out: Path, size: tuple[int, int] = (560, 900)) -> float:
    bar = pillar(cells=16)
    cage = pl.cage_from_box(bar, cells=(1, 1, 4), margin=0.03)
    controls = cage.points.copy()
    top = np.clip(controls[:, 2] - 1.9, 0, None) / 2.2
    turn = 1.7 * top
    x, z = controls[:, 0].copy(), controls[:, 2] - 2
    controls[:, 0] = np.where(top > 0, np.cos(turn) * x + np.sin(turn) * z, x)
    controls[:, 2] = np.where(top > 0, np.cos(turn) * z - np.sin(turn) * x, z) + 2
    panels, shears = [], []
    for kind in ("mean_value", "harmonic", "green"):
        deformer = pl.Cage(cage, coordinates=kind, positions=controls, levels=2)
        panels.append(pl.render(bar, deformer, color="texture", view=(0.5, -1.6, 0.5), size=size))
        stretches = np.linalg.svd(deformer.jacobian(bar.points), compute_uv=False)
        shears.append(np.log(stretches[:, 0] / stretches[:, 2]).mean())
    Image.fromarray(np.hstack(panels)).save(out / "cage_coordinates.png", optimize=True)
    return float(shears[2] / shears[0])
