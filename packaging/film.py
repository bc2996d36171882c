"""A short film, drawn by pliant itself: `python packaging/film.py [FILE]` makes docs/pictures/pliant.mp4 anew.

Three shots of two and a half seconds: a vase in a dancing lattice, a figure that jumps, a knot of jelly. It needs the
extra `film`.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import imageio.v2 as imageio
import numpy as np
from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "docs" / "gallery"))

from bodies import figure  # noqa: E402 -- lies beside the gallery
from shapes import trefoil  # noqa: E402

import pliant as pl  # noqa: E402
from pliant import examples  # noqa: E402
from pliant.io.files import replacing  # noqa: E402
from pliant.rendering.films import draw_film  # noqa: E402

SIZE, FPS, SECONDS = (640, 480), 20, 2.5
TIMES = np.arange(0, SECONDS, 1 / FPS)


def vase() -> tuple[pl.PolygonMesh, np.ndarray, dict]:
    """A lattice of 96 control points dances; 13,920 vertices follow."""
    mesh = examples.vase()
    lattice = pl.BSplineFFD.around(mesh, shape=(4, 4, 6), margin=0.02)
    bound, parts = lattice.bind(mesh), np.sin(2 * np.pi * TIMES / SECONDS)
    poses = [examples.sway(lattice.rest, turn=1.3 * part, lean=0.2 * part) for part in parts]
    still = examples.sway(lattice.rest, turn=0.0, lean=0.0)
    rest = lattice.rest - still  # the dance swells; the film begins and ends at rest
    return (
        mesh,
        np.stack([bound.deform(pose + (1 - abs(part)) * rest) for pose, part in zip(poses, parts, strict=True)]),
        {},
    )


def jump() -> tuple[pl.PolygonMesh, np.ndarray, dict]:
    """A stack of three layers with keys, as in the gallery."""
    import performance

    body = figure()
    clip = performance.jump(body)
    return (
        body,
        np.stack([clip.sample(min(time * 0.65, clip.duration)).points for time in TIMES]),
        {"view": (1, -1.4, 0.35)},
    )


def jelly() -> tuple[pl.PolygonMesh, np.ndarray, dict]:
    """A template on a knot, and a walk around it."""
    knot = trefoil(along=240, around=28)
    clip = pl.template("jelly").clip(knot, duration=SECONDS, intensity=1.5)
    return knot, np.stack([clip.sample(time).points for time in TIMES]), {"turns": 1.0}


SHOTS = {
    "13,920 vertices follow 96 control points": vase,
    "layers, keys, squash and stretch": jump,
    "thirty-four motions fit any mesh": jelly,
}


def pictures() -> Iterator[np.ndarray]:
    """All frames, with a line of words below."""
    font = ImageFont.load_default(22)
    for words, shot in SHOTS.items():
        mesh, frames, look = shot()
        for drawn in draw_film(mesh, frames, size=SIZE, **look):
            picture = Image.fromarray(drawn)
            ImageDraw.Draw(picture).text((SIZE[0] / 2, SIZE[1] - 24), words, "#33383f", font, anchor="ms")
            yield np.asarray(picture)


def main() -> None:
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "pictures" / "pliant.mp4"
    with replacing(path) as temporary, imageio.get_writer(temporary, fps=FPS, codec="libx264", quality=6) as film:
        for picture in pictures():
            film.append_data(picture)
    print(f"{path}: {path.stat().st_size / 2**20:.2f} MB")


if __name__ == "__main__":
    main()
