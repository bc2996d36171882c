"""A figure jumps: anticipation, stretch, landing.

Three layers and their keys: a squash that keeps the volume, a bend, and a map that lifts it all. The figure crouches
before it leaps, is drawn out on the way, and gives way as it lands. The number is how far its last pose is from its
first.
"""

from pathlib import Path

import numpy as np
from bodies import figure
from PIL import Image

import pliant as pl
from pliant.rendering.films import draw_film

SQUASH = {0.0: 1.0, 0.3: 0.72, 0.55: 1.3, 0.8: 1.1, 1.0: 0.72, 1.3: 1.0}
LEAN = {0.0: 0.0, 0.3: 0.5, 0.55: -0.15, 1.0: 0.35, 1.3: 0.0}


def jump(body: pl.PolygonMesh) -> pl.Clip:
    squash, lean = pl.Squash.around(body, profile="constant"), pl.Bend.around(body, axis="x", normal="y", center=0.0)
    stack = pl.Stack([pl.Layer("squash", squash), pl.Layer("lean", lean), pl.Layer("jump", pl.Affine())])
    clip = pl.Clip(body, stack, duration=1.3, fps=24)
    for time, factor in SQUASH.items():
        clip = clip.key("squash", time, {"factor": factor}, "smooth")
    for time, angle in LEAN.items():
        clip = clip.key("lean", time, {"angle": angle}, "smooth")
    clip = clip.key("jump", 0.4, {"controls": pl.Affine().controls})
    clip = clip.key("jump", 0.7, {"controls": pl.Affine.translation([0, 0, 0.9]).controls}, "ease_out")
    return clip.key("jump", 0.95, {"controls": pl.Affine().controls}, "ease_in")


def main(out: Path, size: tuple[int, int] = (1750, 700)) -> float:
    body = figure()
    clip = jump(body)
    poses = np.stack([clip.sample(time).points for time in (0, 0.3, 0.5, 0.7, 0.9, 1.03, 1.3)])
    pictures = draw_film(body, poses, size=(max(size[0] // 7, 16), size[1]), view=(1, -1.4, 0.35))
    Image.fromarray(np.hstack(list(pictures))).resize(size).save(out / "performance.png", optimize=True)
    return float(np.abs(poses[-1] - poses[0]).max())
