"""Shapes that many tests use, made on the spot."""

import numpy as np
import pytest

from pliant.mesh import CornerValues, FaceLabels, PolygonMesh


@pytest.fixture
def random():
    return np.random.default_rng(20)


@pytest.fixture
def box_mesh():
    """A box of quadrangles, 2 x 3 x 1, with a texture chart a side, corner normals and two groups."""
    steps = np.linspace(0, 1, 5)
    sides = []
    for axis in range(3):
        for end in (0.0, 1.0):
            u, v = np.meshgrid(steps, steps, indexing="ij")
            side = np.insert(np.stack([u, v], axis=-1).reshape(-1, 2), axis, end, axis=1)
            sides.append((side, axis, end))
    points = np.vstack([side for side, _, _ in sides])
    faces, normals, groups = [], [], []
    cell = np.array([0, 5, 6, 1])
    for at, (_, axis, end) in enumerate(sides):
        order = cell if (end == 1.0) == (axis != 1) else cell[::-1]
        for i in range(4):
            for j in range(4):
                faces.append(order + 25 * at + 5 * i + j)
                normals += [at] * 4
                groups.append(at % 2)
    pool = np.vstack([np.eye(3)[axis] * (1 if end else -1) for _, axis, end in sides])
    faces = np.array(faces)
    return PolygonMesh(
        points * [2.0, 3.0, 1.0],
        faces,
        uvs=CornerValues(np.delete(points, 2, axis=1), faces.reshape(-1)),
        normals=CornerValues(pool, normals),
        groups=FaceLabels(("low", "high"), groups),
    )
