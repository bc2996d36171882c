"""As rigidly as possible: a leg bends at the knee.

The foot is the handle and is turned by 70°; the lower leg follows as rigidly as it can. Colours show how far each
point moved. The energy decreases in every iteration; the number is the largest ratio of one to the one before.
"""

from pathlib import Path

import numpy as np
from bodies import figure
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (600, 800)) -> float:
    body = figure()
    right = body.points[:, 0] < 0
    leg, foot = right & (body.points[:, 2] < 0.62), right & (body.points[:, 2] < 0.12)
    knee = np.array([-0.13, 0.0, 0.52])
    goal = pl.Affine.rotation("x", np.radians(-70), knee)(body.points[foot])

    edit = pl.ARAP(leg, foot, goal=goal)
    panels = [
        pl.render(body, size=size, view=(-1, 0.6, 0.15)),
        pl.render(body, edit, size=size, view=(-1, 0.6, 0.15), color="displacement", legend=False),
    ]
    Image.fromarray(np.hstack(panels)).save(out / "arap.png")
    energies = edit.bind(body).solve().energies
    return float((energies[1:] / energies[:-1]).max())  # below 1
