"""A turntable: the caricature turns its head.

A picture for each direction of view, put into a GIF that loops; `face_turntable.gif` lies beside the picture, which
shows some of its frames. The number says that it looks straight ahead in the middle of the loop, as at its beginning:
by how many levels of colour the two frames differ.
"""

from pathlib import Path

import numpy as np
import skimage.data
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (360, 430), frames: int = 24) -> float:
    face = pl.dense_face(pl.face_from_photo(skimage.data.astronaut()))
    mesh = pl.caricature(face, 0.8).face.filled().mesh
    turns = np.radians(48) * np.sin(2 * np.pi * np.arange(frames) / frames)
    views = [(np.sin(turn), 0.08, np.cos(turn)) for turn in turns]
    pictures = [pl.render(mesh, view=view, up="y", size=size) for view in views]

    images = [Image.fromarray(picture).quantize(128) for picture in pictures]
    options = {"save_all": True, "append_images": images[1:], "duration": 80, "loop": 0}
    images[0].save(out / "face_turntable.gif", **options)
    shown = [pictures[at] for at in (3 * frames // 4, 7 * frames // 8, 0, frames // 8, frames // 4)]
    Image.fromarray(np.hstack(shown)).save(out / "face_turntable.png", optimize=True)
    return float(np.abs(pictures[0].astype(int) - pictures[frames // 2]).mean())
