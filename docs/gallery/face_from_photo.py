"""A face from a photograph: landmarks, mesh, and a dense face.

A network finds 468 landmarks; they are the vertices of a mesh that wears the photograph. The dense face is the mean
face, subdivided, plus what a Gaussian process makes of the landmarks' differences from it. The photograph, in the
public domain, is one that scikit-image carries. The number says how far, in centimetres, the dense face passes from the
landmarks.
"""

from pathlib import Path

import numpy as np
import skimage.data
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (420, 500)) -> float:
    photograph = skimage.data.astronaut()
    face = pl.face_from_photo(photograph)
    dense = pl.dense_face(face)

    width, height = size
    around = np.rint([225 - 100 * width / height, 20, 225 + 100 * width / height, 220]).astype(int)
    panels = [
        np.asarray(Image.fromarray(photograph).crop(tuple(around)).resize(size, Image.Resampling.LANCZOS)),
        pl.render(face.mesh, show=("mesh", "edges"), view=(0.3, 0.1, 1), up="y", size=size),
        pl.render(dense.mesh.replace(material_library={}), view=(0.3, 0.1, 1), up="y", size=size),
        pl.render(dense.filled().mesh, view=(0.3, 0.1, 1), up="y", size=size),
    ]
    Image.fromarray(np.hstack(panels)).save(out / "face_from_photo.png", optimize=True)
    apart = dense.mesh.points[: len(face.landmarks)] - face.landmarks
    return float(np.sqrt((apart**2).sum(axis=1).mean()))
