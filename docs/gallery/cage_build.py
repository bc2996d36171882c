"""A cage, built: a figure in 120 control points.

`build_cage` makes a coarse closed mesh around any other one and verifies it. Its vertices are the controls: here an arm
goes up and the other forward. Mean value coordinates carry the figure along. The number is how far the figure moves
when the cage does not.
"""

from pathlib import Path

import numpy as np
from bodies import figure
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (800, 900)) -> float:
    body = figure()
    cage = pl.build_cage(body, vertices=120, margin=0.045, symmetry="x")
    assert pl.check_cage(cage, body).ok
    deformer = pl.Cage(cage)
    controls = cage.points.copy()
    for side, angle in ((1, 0.9), (-1, -0.5)):
        reach = (np.clip((side * controls[:, 0] - 0.24) / 0.1, 0, 1) * (cage.points[:, 2] > 0.7))[:, None]
        turn = side * angle
        about = np.array([side * 0.15, 0, 1.42])
        rotation = np.array([[np.cos(turn), 0, -np.sin(turn)], [0, 1, 0], [np.sin(turn), 0, np.cos(turn)]])
        controls += reach * ((controls - about) @ rotation.T + about - controls)
    show, view = ("mesh", "lattice"), (0.35, -1.0, 0.25)
    panels = [pl.render(body, each, show=show, view=view, size=size) for each in (deformer, deformer.moved(controls))]
    Image.fromarray(np.hstack(panels)).save(out / "cage_build.png", optimize=True)
    return float(np.abs(deformer(body).points - body.points).max())  # 0
