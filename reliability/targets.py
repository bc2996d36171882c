"""What deformers are tried on: clouds of points, bodies, faces, drawn at random."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import pliant as pl
from pliant.deformer import Deformer
from pliant.examples import vase

Floats = NDArray[np.float64]
Random = np.random.Generator
Target = pl.PolygonMesh | Floats
Case = tuple[Deformer, Target]


def cloud(random: Random, count: int = 40) -> Floats:
    """(count, 3) points in a box of any size, anywhere near it."""
    size = 10.0 ** random.uniform(-3, 3)
    return size * (random.uniform(-1, 1, (count, 3)) * random.uniform(0.3, 1, 3) + random.normal(size=3))


def body(random: Random) -> pl.PolygonMesh:
    """A closed mesh of some eighty vertices, of any size, turned anyhow."""
    mesh = vase(random.uniform(150, 300), 8, 9)
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    points = (mesh.points * 10.0 ** random.uniform(-4, 1)) @ (turn * np.sign(np.linalg.det(turn)))
    return mesh.with_points(points + np.ptp(points) * random.normal(size=3)).replace(normals=None)


def face(random: Random) -> tuple[Floats, Floats]:
    """(468, 3) landmarks of a face that is nobody's, as wide as a face is, and (40, 3) points around it."""
    mean = pl.mean_face().points
    away = random.normal(size=(3, 3)) * 0.05
    waves = 0.3 * np.sin(mean @ random.normal(size=(3, 3)) * 0.4 + random.uniform(-3, 3, 3))
    landmarks = mean @ (np.eye(3) + away) + waves
    near = landmarks[random.choice(len(landmarks), 40, replace=False)]
    return landmarks, near + 0.5 * random.normal(size=near.shape)


def size_of(target: Target) -> float:
    """The diagonal of a target's bounds."""
    points = target.points if isinstance(target, pl.PolygonMesh) else target
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def disturbed(deformer: Deformer, target: Target, random: Random, amount: float = 0.05) -> Deformer:
    """Controls near rest, by a part of the target's size."""
    return deformer.moved(deformer.rest + amount * size_of(target) * random.normal(size=deformer.rest.shape))
