"""Caricatures: what is a face's own, exaggerated.

Landmarks go away from the mean face, p + k (p − mean), and Dirichlet free-form deformation takes the face along; its
smile is an expression, and stays as it is. From the left: the face; k = 0.7; k = 1.1; k = 0.7 with half as much again
for the brows and the nose, and three times as much for the chin. None of them folds: the number is the least volume
ratio found.
"""

from pathlib import Path

import numpy as np
import skimage.data
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (420, 500)) -> float:
    face = pl.dense_face(pl.face_from_photo(skimage.data.astronaut()))
    caricatures = [
        pl.caricature(face, 0.7),
        pl.caricature(face, 1.1),
        pl.caricature(face, 0.7, {"brows": 1.5, "nose": 1.5, "chin": 3.0}),
    ]
    faces = [face, *(each.face for each in caricatures)]
    panels = [pl.render(each.filled().mesh, view=(0.25, 0.08, 1), up="y", size=size) for each in faces]
    Image.fromarray(np.hstack(panels)).save(out / "face_caricature.png", optimize=True)
    return min(each.least for each in caricatures)
