"""Patches that stay smooth where they meet.

Tricubic Bézier patches share the control points of their joints. Across a joint the map is smooth (C¹) while each
control point there lies in the middle between its two neighbours; `moved_smoothly` keeps it so. The number is the
jump of the Jacobian across a joint.
"""

from pathlib import Path

import numpy as np
from shapes import shell

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    sea_shell = shell()
    lattice = pl.BezierFFD.around(sea_shell, patches=(1, 1, 2), margin=0.02)
    joint_moves = {(i, j, 3): [1.1, -0.8, 0.3] for i in (0, 1, 2, 3) for j in (1, 2)}
    bent = lattice.moved_smoothly({**joint_moves, (1, 1, 6): [-1.5, 1.0, 0.9], (2, 2, 6): [-1.5, 1.0, 0.9]})

    pl.render(sea_shell, bent, out / "smooth_patches.png", color="texture", size=size)
    rng = np.random.default_rng(0)
    low, high = sea_shell.bounds
    joint = low + rng.uniform(0.1, 0.9, (200, 3)) * (high - low)
    joint[:, 2] = sea_shell.center[2]
    aside = np.array([0, 0, 1e-9 * sea_shell.diagonal])
    return float(np.abs(bent.jacobian(joint - aside) - bent.jacobian(joint + aside)).max())  # 0
