"""The contour-mean skeleton of a horse.

The first ten eigenvectors of the Laplacian keep the pose and lose the details; the second one runs along the body,
and its isolines cut it. Each loop becomes a point: four legs are four loops of the same level. The colours are the
groups of vertices that the points stand for. The number counts the skeleton's ends: muzzle, tail and hooves.
"""

from pathlib import Path

import numpy as np
from bodies import horse
from PIL import Image

import pliant as pl


def main(out: Path, size: tuple[int, int] = (800, 640)) -> float:
    body, _ = horse()
    skeleton = pl.contour_skeleton(body, contours=30)

    order = np.random.default_rng(3).permutation(len(skeleton.points))
    bones = [rod(*skeleton.points[link]) for link in skeleton.links]
    faces = np.vstack([bone.triangles + 12 * at for at, bone in enumerate(bones)])
    drawn = pl.PolygonMesh(np.vstack([bone.points for bone in bones]), faces)
    view = (-0.5, 1, 0.3)
    panels = [pl.render(body, color=order[skeleton.groups].astype(float), legend=False, view=view, size=size)]
    panels.append(pl.render(drawn, view=view, size=size))
    Image.fromarray(np.hstack(panels)).save(out / "contour_skeleton.png")
    return float((np.bincount(skeleton.links.ravel()) == 1).sum())


def rod(start, end, radius=0.016):
    """A thin hexagonal rod."""
    along = (end - start) / np.linalg.norm(end - start)
    across = np.linalg.svd(along[None])[2][1:]
    turn = np.arange(6) * np.pi / 3
    ring = radius * (np.cos(turn)[:, None] * across[0] + np.sin(turn)[:, None] * across[1])
    at, after = np.arange(6), (np.arange(6) + 1) % 6
    return pl.PolygonMesh(np.vstack([start + ring, end + ring]), np.column_stack([at, after, after + 6, at + 6]))
