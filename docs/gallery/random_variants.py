"""Many of one: training data from a single mesh.

A batch draws the coefficients of a random field for each copy, from a seed of its own, and writes the meshes; on one
machine or a cluster, the files are the same. The number is the greatest difference to the same copies from two threads.
"""

import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from bodies import horse
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (1500, 820)) -> float:
    body, _ = horse(0.04)
    kernel = pl.GaussianKernel(sigma=0.35 * body.diagonal, scale=0.03 * body.diagonal)
    field = pl.GaussianProcess(kernel).sample(domain=body, seed=0)
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        source = Path(folder, "horse.ply")
        pl.write(body, source)
        made = [batch(field, source, name, pool) for name in ("first", "second")]
        herds = [[pl.read(path) for path in sorted(outcome.output for outcome in outcomes)] for outcomes in made]
    cell = (max(size[0] // 4, 16), max(size[1] // 2, 16))
    pictures = [pl.render(each, view=(-0.6, 1, 0.35), size=cell) for each in herds[0]]
    rows = [np.hstack(pictures[:4]), np.hstack(pictures[4:])]
    Image.fromarray(np.vstack(rows)).resize(size).save(out / "random_variants.png", optimize=True)
    return float(max(np.abs(a.points - b.points).max() for a, b in zip(*herds, strict=True)))


def batch(field, source, name, pool):
    where = source.parent / name / "{stem}-{copy:02d}.ply"
    crew = {"executor": pool} if name == "second" else {"workers": 0}
    return pl.batch.sample(field, [source], where, count=8, seed=7, **crew)
