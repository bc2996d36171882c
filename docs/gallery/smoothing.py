"""A rough horse becomes smooth again.

Noise (left) is taken off by the implicit flow (middle), which is stable however strong it is, and by Taubin's filter
(right), which keeps the volume: the number is the volume after it, over the horse's own.
"""

from pathlib import Path

import numpy as np
from bodies import horse
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (560, 520)) -> float:
    body, _ = horse()
    noise = np.random.default_rng(0).normal(size=(len(body.points), 1)) * 0.006
    rough = body.with_points(body.points + noise * body.vertex_normals)

    flow = pl.smooth(rough, 6, strength=2.0)
    taubin = pl.smooth(rough, 12, method="taubin")
    panels = [pl.render(mesh, view=(-0.6, 1, 0.25), size=size) for mesh in (rough, flow, taubin)]
    Image.fromarray(np.hstack(panels)).save(out / "smoothing.png")
    return pl.volume(taubin) / pl.volume(body)
