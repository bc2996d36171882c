"""Smooth shapes to fit models to."""

import numpy as np
import pytest

import pliant as pl


def ellipsoid(rings, around, axes=(3.0, 2.0, 1.0)):
    """A closed mesh of triangles."""
    theta = np.linspace(0, np.pi, rings + 1)[1:-1]
    phi = np.linspace(0, 2 * np.pi, around, endpoint=False)
    t, p = np.meshgrid(theta, phi, indexing="ij")
    points = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=-1).reshape(-1, 3)
    points = np.vstack([points, [[0, 0, 1], [0, 0, -1]]]) * axes
    faces = []
    for i in range(rings - 2):
        for j in range(around):
            k = (j + 1) % around
            faces += [
                [i * around + j, (i + 1) * around + j, (i + 1) * around + k],
                [i * around + j, (i + 1) * around + k, i * around + k],
            ]
    last = (rings - 2) * around
    for j in range(around):
        k = (j + 1) % around
        faces += [[len(points) - 2, j, k], [len(points) - 1, last + k, last + j]]
    return pl.PolygonMesh(points, np.array(faces))


@pytest.fixture(scope="session")
def coarse():
    return ellipsoid(16, 24)


@pytest.fixture(scope="session")
def fine():
    return ellipsoid(37, 50)


@pytest.fixture(scope="session")
def soft(coarse):
    """A smooth model of the coarse ellipsoid."""
    return pl.ShapeModel.from_kernel(coarse, pl.GaussianKernel(3.0, 0.25), rank=12)
