"""Points spread over a shape: by area, far apart, or at random among its vertices."""

from __future__ import annotations

from typing import Literal

import numpy as np

from pliant.errors import InvalidParameter
from pliant.mesh import Points, PolygonMesh

Spread = Literal["area", "farthest", "random"]


def surface_samples(mesh: PolygonMesh, count: int, spread: Spread = "area", seed: int = 0) -> Points:
    """(count, 3) points of a shape.

    Parameters
    ----------
    mesh
        The shape; without faces, its vertices are all that there is.
    count
        How many; no more than there are vertices, where vertices are taken.
    spread
        ``"area"``: uniformly over the surface; ``"farthest"``: vertices, each as far as can be from those before it;
        ``"random"``: vertices at random.
    seed
        Of the random choice.

    Raises
    ------
    InvalidParameter
        No points, or an unknown word.
    """
    random = np.random.default_rng(seed)
    if spread not in ("area", "farthest", "random"):
        raise InvalidParameter(f"samples are spread by 'area', 'farthest' or at 'random', not {spread!r}")
    if count < 1 or not len(mesh.points):
        raise InvalidParameter(f"{count} samples of {len(mesh.points)} points: there must be at least one")
    if spread == "area" and len(mesh.triangles):
        return _by_area(mesh, count, random)
    few = min(count, len(mesh.points))
    if spread == "farthest":
        return mesh.points[farthest(mesh.points, few, random)]
    return mesh.points[np.sort(random.choice(len(mesh.points), few, replace=False))]


def _by_area(mesh: PolygonMesh, count: int, random: np.random.Generator) -> Points:
    """One point in each of ``count`` pieces of equal area: less noisy than independent ones."""
    corners = mesh.points[mesh.triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    if not area.sum() > 0:
        return mesh.points[random.choice(len(mesh.points), min(count, len(mesh.points)), replace=False)]
    level = (np.arange(count) + random.random(count)) / count * area.sum()
    chosen = corners[np.minimum(np.searchsorted(np.cumsum(area), level), len(area) - 1)]
    root, share = np.sqrt(random.random(count)), random.random(count)
    weights = np.stack([1 - root, root * (1 - share), root * share], axis=1)
    return np.asarray(np.einsum("mc,mcd->md", weights, chosen))


def farthest(points: Points, count: int, random: np.random.Generator) -> list[int]:
    """Vertices, each as far as can be from those before it."""
    chosen = [int(random.integers(len(points)))]
    distance = ((points - points[chosen[0]]) ** 2).sum(axis=1)
    while len(chosen) < count:
        chosen.append(int(np.argmax(distance)))
        np.minimum(distance, ((points - points[chosen[-1]]) ** 2).sum(axis=1), out=distance)
    return chosen
