"""Laplacian editing lifts an arm.

The hand is the handle, the arm the region of interest; the rest of the body does not move by a bit. The bi-harmonic
form (left) spreads the displacement smoothly, and shears what should turn; with local similarities (right) the
surface turns along, found in the same linear solve. The number is how far the hand is from its goal in the first.
"""

from pathlib import Path

import numpy as np
from bodies import figure
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (600, 800)) -> float:
    body = figure()
    along = -body.points[:, 0]
    arm, hand = np.flatnonzero(along > 0.2), np.flatnonzero(along > 0.6)
    shoulder = np.array([-0.15, 0.0, 1.42])
    turn = pl.Affine.rotation("y", np.radians(28), shoulder)
    goal = turn(body.points[hand])

    edits = [pl.LaplacianEdit(arm, hand, method=method) for method in ("biharmonic", "similarity")]
    panels = [pl.render(edit.moved(goal)(body), view=(0.2, 1, 0.1), size=size) for edit in edits]
    Image.fromarray(np.hstack(panels)).save(out / "laplacian_edit.png")
    return float(np.abs(edits[0].bind(body).deform(goal)[hand] - goal).max())  # 0: the handle is held
