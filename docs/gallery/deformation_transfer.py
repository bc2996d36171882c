"""A camel does what a horse does.

The two meshes differ in vertices, triangles and shape; 44 markers at the joints say what corresponds. The horse is
posed with two edits, and its deformation is carried over triangle by triangle. At rest the camel is itself, exactly:
that is the number.
"""

from pathlib import Path

import numpy as np
from bodies import camel, horse
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (440, 400)) -> float:
    (source, ours), (target, theirs) = horse(), camel()
    clone = pl.DeformationTransfer(source, target, np.column_stack([ours, theirs]))

    x, y, z = source.points.T
    neck, head = np.flatnonzero((x < -0.5) & (z > 1.0)), np.flatnonzero((x < -0.82) & (z > 1.1))
    leg = (x < -0.3) & (y > 0.02) & (z < 0.75)
    down = pl.Affine.rotation("y", np.radians(-55), (-0.5, 0, 1.0))(source.points[head])
    bowed = pl.ARAP(neck, head, goal=down)(source)
    foot = leg & (z < 0.3)
    raised = pl.ARAP(leg, foot, goal=source.points[foot] + [-0.35, 0, 0.3])(bowed)

    meshes = source, raised, target, clone(raised)
    panels = [pl.render(mesh, view=(-0.6, 1, 0.25), size=size) for mesh in meshes]
    Image.fromarray(np.hstack(panels)).save(out / "deformation_transfer.png")
    return float(np.abs(clone.points(source) - target.points).max())
