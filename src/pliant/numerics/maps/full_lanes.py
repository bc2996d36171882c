"""Kernels work on eight points at a time: fewer than eight are filled up."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

LANES = 8


def filled(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The (n, 3) points themselves, or, where they are fewer than eight, (8, 3) with zeros below them."""
    if len(points) >= LANES:
        return points
    return np.vstack([points, np.zeros((LANES - len(points), 3))])
