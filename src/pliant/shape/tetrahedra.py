"""The surface of a tetrahedral mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Cells = NDArray[np.int32]

_SIDES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def boundary(points: Floats, cells: Cells) -> Cells:
    """(t, 3) the sides that belong to one tetrahedron of (m, 4) alone, each seen counter-clockwise from outside."""
    corners = points[cells]
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1])
    turned = np.where(volume[:, None] < 0, cells[:, [0, 2, 1, 3]], cells)
    sides = turned[:, _SIDES].reshape(-1, 3)
    _, first, count = np.unique(np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True)
    return np.asarray(sides[np.sort(first[count == 1])], np.int32)
