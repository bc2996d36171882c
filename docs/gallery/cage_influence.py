"""Influence of a control point: how much each place follows one vertex of a cage.

From left to right mean value, harmonic and maximum entropy coordinates of the same vertex, at the hand. Mean values
reach through the hollow between arm and body; harmonic ones go around it; maximum entropy weights are never negative.
The number is the least of them.
"""

from pathlib import Path

import numpy as np
from bodies import figure
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (560, 720)) -> float:
    body = figure()
    cage = pl.build_cage(body, vertices=90, margin=0.03)
    vertex = int((cage.points @ [1.0, -0.2, -0.3]).argmax())
    panels, least = [], 0.0
    for kind in ("mean_value", "harmonic", "maximum_entropy"):
        deformer = pl.Cage(cage, coordinates=kind)
        weights = deformer.bind(body).matrix()[:, vertex]
        panels.append(
            pl.render(
                body, deformer, color=np.cbrt(weights), limits=(0.0, 0.9), legend=False, view=(0.3, -1, 0.2), size=size
            )
        )
        least = float(weights.min())
    Image.fromarray(np.hstack(panels)).save(out / "cage_influence.png", optimize=True)
    return least
