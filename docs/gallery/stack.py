"""A stack of layers.

Each picture adds a layer: a lattice that broadens chest and shoulders, a twist of the upper body at half strength, a
bow that a mask keeps from the legs. Any of them can be moved, muted or removed later; only what stands above it is
computed anew. The number is what muting all of them leaves of the deformation: nothing.
"""

from pathlib import Path

import numpy as np
from bodies import figure
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1800, 620)) -> float:
    body = figure()
    lattice = pl.BSplineFFD.around(body, shape=(5, 4, 6), margin=0.05)
    controls = lattice.rest.copy()
    controls[:, :, 3:5, 0] *= 1.45
    upper = np.clip((body.points[:, 2] - 0.85) / 0.3, 0, 1)
    bow = pl.Bend.around(body, normal=[0, -1, 0], angle=0.9, bounds=(0.8, 1.8), center=0.8)
    stack = pl.Stack(
        [
            pl.Layer("shoulders", lattice.moved(controls)),
            pl.Layer("turn", pl.Twist.around(body, angle=1.2, bounds=(0.8, 1.5), profile="smooth"), envelope=0.5),
            pl.Layer("bow", bow, mask=upper),
        ]
    )
    shown = [pl.Stack(stack.layers[:count])(body) for count in range(len(stack) + 1)]
    room = pl.PolygonMesh(np.vstack([mesh.points for mesh in shown]))  # one camera for all
    parts = [pl.PolygonMesh(np.vstack([mesh.points, *room.bounds]), mesh.faces) for mesh in shown]
    pictures = [pl.render(part, size=(size[0] // 4, size[1]), view=(0.8, -2, 0.4)) for part in parts]
    Image.fromarray(np.hstack(pictures)).save(out / "stack.png")
    quiet = stack
    for name in stack.names:
        quiet = quiet.replace(name, muted=True)
    return float(np.abs(quiet(body).points - body.points).max())
