"""Control points anywhere: a shell grows spines.

Dirichlet free-form deformation needs no lattice: control points may lie anywhere, here on the shape itself. A point
follows its natural neighbours, weighted by Sibson's coordinates; with `smooth=True` the map is smooth (C¹) at the
control points too. The number says how well a site goes where it is moved.
"""

from pathlib import Path

import numpy as np
from shapes import shell

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    sea_shell = shell()
    chosen = [0]  # one after the other, the point that is farthest from all before
    distance = np.full(len(sea_shell.points), np.inf)
    while len(chosen) < 260:
        distance = np.minimum(distance, np.linalg.norm(sea_shell.points - sea_shell.points[chosen[-1]], axis=1))
        chosen.append(int(distance.argmax()))
    sites = sea_shell.points[chosen]
    lattice = pl.DirichletFFD(sites, smooth=True)

    growth = 1 - sites[:, 2] / 3.4  # the shell is thin where it begins
    outwards = np.hypot(sites[:, 0], sites[:, 1]) > 1.25 * growth
    spines = np.flatnonzero(outwards & (growth > 0.15))[::2]
    controls = lattice.rest.copy()
    controls[spines] -= 0.5 * growth[spines, None] * sea_shell.vertex_normals[np.array(chosen)[spines]]
    spiny = lattice.moved(controls)

    pl.render(sea_shell, spiny, out / "dirichlet_ffd.png", color="texture", view=(0.4, -1.3, 0.5), size=size)
    return float(np.abs(spiny(sites) - controls).max())  # 0
