"""Key frames: a pillar is squeezed and wrung.

Keys, and what lies between them: a twist eases in and out while a tool, a ring that squeezes, glides from the foot to
the top. Both keep the volume at every point; the number is how far that of the mesh strays on the way, relatively.
"""

from pathlib import Path

import numpy as np
from PIL import Image
from shapes import pillar

import pliant as pl
from pliant.rendering.films import draw_film


def main(out: Path, size: tuple[int, int] = (1750, 620)) -> float:
    body = pillar()
    low, high = body.bounds
    middle, height = body.center[2], high[2] - low[2]
    band = (middle - 0.2 * height, middle + 0.2 * height)
    stack = pl.Stack(
        [
            pl.Layer("ring", pl.Squash.around(body, factor=1.9, bounds=band)),
            pl.Layer("turn", pl.Twist.around(body, profile="smooth")),
        ]
    )
    clip = pl.Clip(body, stack, duration=2.0, fps=24)
    for time, place in ((0.0, -0.5), (2.0, 0.5)):
        clip = clip.key("ring", time, {"frame": pl.Affine.translation([0, 0, place * height])}, "ease_in_out")
    clip = clip.key("turn", 0.0, {"angle": 0.0}).key("turn", 2.0, {"angle": 1.5 * np.pi}, "ease_in_out")
    poses = np.stack([clip.sample(time).points for time in np.linspace(0, 2, 7)])
    pictures = draw_film(body, poses, size=(max(size[0] // 7, 16), size[1]), view=(1, -1.4, 0.4))
    Image.fromarray(np.hstack(list(pictures))).resize(size).save(out / "key_frames.png")
    volumes = [abs(pl.volume(body.with_points(pose))) for pose in poses]
    return float(np.ptp(volumes) / np.mean(volumes))
