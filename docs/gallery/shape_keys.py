"""Shape keys: the layers of a stack as sliders.

Each layer of a stack becomes a key, a displacement for every vertex with a weight: the morph targets that games and
animation programs play. From the bottom left, one grows upwards and the other to the right, even beyond what it was.
The number is how far all keys together are from the stack: nothing.
"""

from pathlib import Path

import numpy as np
from PIL import Image

import pliant as pl
from pliant import examples


def main(out: Path, size: tuple[int, int] = (1400, 960)) -> float:
    vase = examples.vase()
    turned, lean = pl.Twist.around(vase, angle=1.2), pl.Bend.around(vase, axis="y", normal="x", angle=0.7, center=0.0)
    stack = pl.Stack([pl.Layer("twist", turned), pl.Layer("bend", lean)])
    keys = pl.bake_shape_keys(stack, vase)
    levels, cell = (0.0, 0.5, 1.0, 1.25), (max(size[0] // 4, 16), max(size[1] // 3, 16))
    look = {"color": "texture", "show": ("mesh",), "size": cell}
    rows = [
        np.hstack([pl.render(keys.moved([across, up])(vase), **look) for across in levels]) for up in (1.0, 0.5, 0.0)
    ]
    Image.fromarray(np.vstack(rows)).resize(size).save(out / "shape_keys.png", optimize=True)
    return float(np.abs(keys.moved([1, 1])(vase).points - stack(vase).points).max() / vase.diagonal)
