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
    from pliant.numerics.compute.chunks import for_chunks
    from pliant.numerics.rigid.polar import rotate_all

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


def turning_vectors(before: Floats, after: Floats) -> Floats:
    """(n, 3) the shortest rotation vectors that turn the directions of (n, 3) into those of (n, 3) others.

    Zero where a direction is none; smooth but at half turns; complex directions as in :func:`rotations_of`.
    """
    cross = np.cross(before, after)
    size = np.sqrt((before**2).sum(axis=1)) * np.sqrt((after**2).sum(axis=1))
    cosine = (before * after).sum(axis=1)
    sine = np.sqrt((cross**2).sum(axis=1))
    flat = np.abs(sine) <= 1e-7 * np.abs(size)  # half the angle has the tangent sine / (size + cosine)
    nothing = np.abs(size + cosine) <= 1e-14 * np.abs(size)
    safe = np.where(nothing, 1.0, size + cosine)
    angle_by_sine = 2 * np.arctan(np.where(flat, 0.0, sine) / safe) / np.where(flat, 1.0, sine)
    return np.asarray(cross * np.where(flat, 2 / safe, angle_by_sine)[:, None])
