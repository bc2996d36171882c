"""The rotation nearest to a 3 x 3 matrix, for many at once; and rotation matrices from rotation vectors.

The rotation that maximises tr(R^T S) is, as a unit quaternion, the eigenvector of a symmetric 4 x 4 matrix to its
largest eigenvalue (Horn 1987). That form needs no care for reflections: a quaternion never is one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def nearest_rotations(matrices: Floats) -> Floats:
    """(n, 3, 3) rotations R that maximise tr(R^T S) for (n, 3, 3) matrices S; the identity where S is zero."""
    from pliant.numerics.chunks import for_chunks
    from pliant.numerics.polar import rotate_all

    flat = np.ascontiguousarray(matrices, np.float64).reshape(-1)
    out = np.empty_like(flat)
    for_chunks(lambda start, stop: rotate_all(flat, start, stop, out), len(flat) // 9, 8192)
    return out.reshape(-1, 3, 3)


def rotations_of(vectors: Floats) -> Floats:
    """(n, 3, 3) rotations about (n, 3) vectors by their length in radians (Rodrigues), smooth at zero.

    Complex vectors give the analytic continuation, for derivatives by a complex step.
    """
    square = (vectors**2).sum(axis=1)
    small = np.abs(square) < 1e-8
    safe = np.where(small, 1.0, square)
    angle = np.sqrt(safe)
    one = np.where(small, 1 - square / 6, np.sin(angle) / angle)
    two = np.where(small, 0.5 - square / 24, (1 - np.cos(angle)) / safe)
    x, y, z = vectors.T
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
    return np.asarray(np.eye(3) + one[:, None, None] * cross + two[:, None, None] * (cross @ cross))
