"""Normals under a deformation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def cofactor(jacobian: Floats) -> Floats:
    """(n, 3, 3) cofactor matrices, det(J) J^-T, which carry normals; defined for singular J too (Barr 1984, eq. 3)."""
    a, b, c = jacobian[:, 0], jacobian[:, 1], jacobian[:, 2]
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)


def carry_normals(jacobian: Floats, normals: Floats) -> Floats:
    """(n, 3) unit normals carried by (n, 3, 3) Jacobians; a normal that vanishes stays as it was."""
    carried = np.einsum("nij,nj->ni", cofactor(jacobian), normals)
    length = np.linalg.norm(carried, axis=1, keepdims=True)
    result = normals.copy()
    np.divide(carried, length, out=result, where=length > 0)
    return result
