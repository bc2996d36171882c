"""Scale: a vase, wider and lower.

Each axis by a factor of its own, away from the middle. The number is det J, the product of the factors.
"""

from pathlib import Path

import pliant as pl
from pliant import examples


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    vase = examples.vase()
    scale = pl.Scale.around(vase, x=1.6, y=1.1, z=0.6)
    pl.render(vase, scale, out / "scale.png", color="texture", show=("mesh",), size=size)
    return float(pl.volume_ratio(scale, vase).mean())
