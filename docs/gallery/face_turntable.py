"""A turntable: the caricature turns its head.

Thirteen directions of view, there and back again, make a GIF that loops; `face_turntable.gif` lies beside the picture,
which shows some of them. The number says how many frames the GIF has.
"""

from pathlib import Path

import numpy as np
import skimage.data
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (300, 360), views: int = 13) -> float:
    face = pl.dense_face(pl.face_from_photo(skimage.data.astronaut()))
    mesh = pl.caricature(face, 0.8).face.filled().mesh
    turns = np.radians(-48) * np.cos(np.pi * np.arange(views) / (views - 1))
    pictures = [pl.render(mesh, view=(np.sin(turn), 0.08, np.cos(turn)), up="y", size=size) for turn in turns]

    frames = [Image.fromarray(picture).quantize(128) for picture in pictures + pictures[-2:0:-1]]
    frames[0].save(out / "face_turntable.gif", save_all=True, append_images=frames[1:], duration=80, loop=0)
    shown = [pictures[round(part * (views - 1))] for part in (0, 0.25, 0.5, 0.75, 1)]
    Image.fromarray(np.hstack(shown)).save(out / "face_turntable.png", optimize=True)
    with Image.open(out / "face_turntable.gif") as film:
        return float(film.n_frames)
