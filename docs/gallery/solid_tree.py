"""A tree of solids: a lamp of superquadrics, each deformed before it is joined.

Barr's deformations are modelling operators like the booleans: the shade is twisted, tapered, hollowed out and pierced,
the stem twisted like barley sugar. The number counts edges that do not close: there are none.
"""

from pathlib import Path

import numpy as np

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    shapes = pl.shapes
    shade = hull(2.2, 3.2) - hull(1.9, 2.9)
    for turn in range(4):
        window = shapes.superquadric((6, 0.5, 1.4), (0.5, 0.5), name="window")
        shade = shade - window.turned("z", turn * np.pi / 4)
    foot = shapes.superquadric((2.6, 2.6, 0.7), (0.6, 1.0), (0, 0, -3.2), name="foot")
    mesh = (shade | stem() | foot).mesh
    color = mesh.groups.indices.astype(float)
    pl.render(mesh, None, out / "solid_tree.png", color=color, legend=False, view=(0.9, -2.2, 0.6), size=size)
    return float(sum(mesh.edge_use))


def hull(width: float, height: float) -> pl.shapes.Solid:
    body = pl.shapes.superquadric((width, width, height), (0.35, 0.35), segments=192, name="shade")
    twisted = body.deformed(pl.Twist(axis="z", angle=np.pi / 2, bounds=(-1.6, 1.6)), edge=np.inf)
    return twisted.deformed(pl.Taper(axis="z", factor=0.55, bounds=(-1.6, 1.6)), edge=np.inf)


def stem() -> pl.shapes.Solid:
    rod = pl.shapes.superquadric((0.5, 0.5, 2.2), (0.2, 0.4), (0, 0, -2.2), name="stem")
    sugar = rod.deformed(pl.Twist(axis="z", angle=3 * np.pi, bounds=(-3.3, -1.1)), edge=0.04)
    return sugar | pl.shapes.torus(0.4, 0.12, (0, 0, -1.9), name="ring") | pl.shapes.sphere(0.45, name="bulb")
