"""What the tests of Barr's deformations share: points, places where profiles have kinks, and plain NumPy."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from pliant.space.axial import AxialDeformer
from pliant.space.profile import Curve

POINTS = np.random.default_rng(3).normal(size=(200, 3)) * [0.5, 0.4, 1.0]
SKEW = {"axis": [1.0, 2.0, 3.0], "origin": [0.1, 0.2, -0.1]}
KEYS = [(0.1, 0.0), (0.4, 1.0), (0.8, 0.3)]

directions = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1)
bounds = st.tuples(st.floats(-1.5, 0.4), st.floats(0.1, 1.5)).map(lambda b: (b[0], b[0] + b[1]))


def smooth(deformer: AxialDeformer):
    """Tells which points are away from the kinks: bounds, joints of pieces, the axis of tubes."""
    kinks = list(deformer.bounds)
    curve = getattr(deformer, "_curve", None)
    if isinstance(curve, Curve):
        kinks += list(deformer.bounds[0] + deformer._width * curve.pieces[:, 0])
    return lambda points: (
        np.abs(np.subtract.outer(deformer._sections(points), kinks)).min(axis=1)
        > 0.01 + (0.01 if not deformer.radial else 0.0)
    )


def carried(deformer, points, normals):
    """Unit normals by the cofactor matrix, from finite differences of the map."""
    step = 1e-5
    columns = [(deformer(points + step * e) - deformer(points - step * e)) / (2 * step) for e in np.eye(3)]
    a, b, c = columns
    images = normals[:, :1] * np.cross(b, c) + normals[:, 1:2] * np.cross(c, a) + normals[:, 2:] * np.cross(a, b)
    return images / np.linalg.norm(images, axis=1, keepdims=True)


def square(t):
    return t**2


def twice(t):
    return 2 * t


def third(t):
    return t**3 / 3
