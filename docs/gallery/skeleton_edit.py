"""A horse lowers its head: contour-mean skeleton editing.

The skeleton of the neck follows the head, and the details are put back, turned. Plainly (left) groups of vertices
move in steps and the surface tears where it meets the fixed body; with the displacements smoothed (right, as it is
by default) it does not. The number is the roughness that smoothing leaves: the mean edge stretch over the plain one's.
"""

from pathlib import Path

import numpy as np
from bodies import horse
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (720, 640)) -> float:
    body, _ = horse()
    x, _, z = body.points.T
    neck, head = np.flatnonzero((x < -0.5) & (z > 1.0)), np.flatnonzero((x < -0.82) & (z > 1.1))
    goal = pl.Affine.rotation("y", np.radians(-65), (-0.5, 0, 1.0))(body.points[head])

    plain = pl.SkeletonEdit(neck, head, goal=goal, finish="none", profile=np.ones_like)(body)
    smooth = pl.SkeletonEdit(neck, head, goal=goal)(body)
    panels = [pl.render(mesh, view=(-0.6, 1, 0.25), size=size) for mesh in (plain, smooth)]
    Image.fromarray(np.hstack(panels)).save(out / "skeleton_edit.png")
    return stretch(body, smooth) / stretch(body, plain)


def stretch(before, after):
    """How far edges are from their lengths at rest, on average."""
    one, two = (np.linalg.norm(np.diff(mesh.points[before.edges], axis=1), axis=2) for mesh in (before, after))
    return float(np.abs(two - one).mean())
