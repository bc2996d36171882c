"""A shape model of brain surfaces and its metrics: `python benchmarks/brain_surfaces.py`.

The package nilearn carries the surfaces of fsaverage5: white matter, pial and inflated, of both hemispheres, 10,242
vertices each. (`pip install --no-deps nilearn nibabel`; nothing else of it is needed.)
"""

from __future__ import annotations

import gzip
import importlib.util
from pathlib import Path

import numpy as np

import pliant as pl

KINDS = ("white", "pial", "infl")


def surfaces():
    """Six meshes with the same triangles; right hemispheres are mirrored."""
    import nibabel

    folder = Path(importlib.util.find_spec("nilearn").submodule_search_locations[0]) / "datasets/data/fsaverage5"
    meshes = []
    for side, sign in (("left", 1), ("right", -1)):
        for kind in KINDS:
            data = gzip.decompress((folder / f"{kind}_{side}.gii.gz").read_bytes())
            points, triangles = nibabel.GiftiImage.from_bytes(data).agg_data()
            meshes.append(pl.PolygonMesh(points * np.array([sign, 1.0, 1.0]), triangles))
    return meshes


def main():
    meshes = surfaces()
    model = pl.learn_model(meshes)
    left_out = pl.leave_one_out(meshes)
    print("| fields | compactness | specificity, mm |")
    print("|--:|--:|--:|")
    for rank in range(1, model.rank + 1):
        few = model.truncated(rank)
        print(f"| {rank} | {pl.compactness(model)[rank - 1]:.3f} | {pl.specificity(few, meshes, samples=200):.2f} |")
    print()
    print("| left out | " + " | ".join(f"{kind}, {side}" for side in ("left", "right") for kind in KINDS) + " |")
    print("|---|" + "--:|" * len(meshes))
    print("| generalisation, mm | " + " | ".join(f"{each:.2f}" for each in left_out) + " |")


if __name__ == "__main__":
    main()
