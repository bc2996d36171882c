"""From a photograph to a face: `python benchmarks/face.py`. No peer does it without a network connection or a GPU."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import skimage.data
from PIL import Image

import pliant as pl
from measure import Comparison, report
from pliant.face.expressions import expression
from pliant.face.landmarks import find_landmarks


def main() -> None:
    photograph = Image.fromarray(skimage.data.astronaut())
    with tempfile.TemporaryDirectory() as name:
        path, out = Path(name) / "photo.jpg", Path(name) / "face.obj"
        photograph.save(path)
        face = pl.face_from_photo(path)
        dense = pl.dense_face(face)
        handles = pl.FaceHandles(face.landmarks)
        bound = handles.bind(dense.mesh)
        smiling, points = handles.rest + expression("smile"), np.empty_like(dense.mesh.points)
        tasks = {
            "landmarks in 512 × 512 pixels (goal: 200 ms)": lambda: find_landmarks(photograph),
            "photograph to textured OBJ (goal: 1,500 ms)": lambda: pl.face_from_photo(path).write(out),
            "dense face, 6,990 vertices": lambda: pl.dense_face(face),
            "caricature of the dense face, sites": lambda: pl.caricature(dense, 0.8),
            "caricature of the dense face, lattice, proved": lambda: pl.caricature(dense, 0.8, by="lattice"),
            "an expression on the dense face, bound": lambda: bound.deform(smiling, out=points),
        }
        comparisons = [Comparison(task, {"pliant": work}, rounds=3) for task, work in tasks.items()]
        print(report("Faces", comparisons, ["pliant", "numpy", "ai-edge-litert"]))


if __name__ == "__main__":
    main()
