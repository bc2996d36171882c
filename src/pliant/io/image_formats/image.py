"""What an image is, whatever its file: voxels, and where they lie."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Image:
    """A regular grid of voxels in space.

    Parameters
    ----------
    values
        (nx, ny, nz) or (nx, ny, nz, k): numbers of any type, k of them a voxel.
    origin
        (3,) the centre of voxel (0, 0, 0), RAS.
    spacing
        (3,) distance of the voxels' centres along each axis.
    axes
        (3, 3) orthonormal; its columns are the axes of the grid, RAS.
    carrier
        What a reader kept of the file. Opaque.
    """

    values: NDArray[Any]
    origin: Floats
    spacing: Floats
    axes: Floats = field(default_factory=lambda: np.eye(3))
    carrier: Any = None

    @property
    def shape(self) -> tuple[int, int, int]:
        """Numbers of voxels along each axis."""
        nx, ny, nz = self.values.shape[:3]
        return nx, ny, nz
