"""A face is moved by its features: brows, lids, lips, chin.

Twenty-five named handles take 175 landmarks along, and Dirichlet free-form deformation takes the face. Expressions are
positions of the handles: here a smile taken back, raised brows, a frown, and a surprise made of two. The number says
how far a symmetric face stays from symmetry.
"""

from pathlib import Path

import numpy as np
import skimage.data
from PIL import Image

import pliant as pl
from pliant.face.expressions import expression
from pliant.face.topology import mirrored


def main(out: Path, size: tuple[int, int] = (420, 500)) -> float:
    face = pl.dense_face(pl.face_from_photo(skimage.data.astronaut())).filled()
    handles = pl.FaceHandles(face.landmarks)
    bound = handles.bind(face.mesh)  # once; each expression is then one product
    surprise = expression("open mouth") + 1.2 * expression("raised brows")
    moves = [-0.9 * expression("smile"), expression("raised brows"), expression("frown"), 0.8 * surprise]
    meshes = [face.mesh.with_points(bound.deform(handles.rest + move)) for move in moves]
    panels = [pl.render(mesh, view=(0.25, 0.08, 1), up="y", size=size) for mesh in meshes]
    Image.fromarray(np.hstack(panels)).save(out / "face_handles.png", optimize=True)

    mean = pl.mean_face()
    smiling = pl.FaceHandles(mean.points).shifted({"mouth": (0, 0.3, 0), "brows": (0, 0.5, 0)})(mean.points)
    return float(np.abs(mirrored(smiling) - smiling).max())
