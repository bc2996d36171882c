"""Where a lattice lies: its origin, spacing and axes, as a file says or laid around a mesh."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidTarget
from pliant.mesh import PolygonMesh

Floats = NDArray[np.float64]

_FLAT = 1e-9  # an extent below this, relative to the largest, is none


@dataclass(frozen=True, eq=False)
class LatticeFrame:
    """The frame of a regular lattice.

    Parameters
    ----------
    origin
        (3,) the position of control point (0, 0, 0).
    spacing
        (3,) the distance between neighbours along each axis.
    axes
        (3, 3) orthonormal; its columns are the axes.
    """

    origin: Floats
    spacing: Floats
    axes: Floats

    def world(self, local: Floats) -> Floats:
        """Vectors (..., 3) along the lattice axes in world coordinates.

        Each number is computed alike whatever the array's shape, so that the same vector always gives the very
        same result.
        """
        a, b, c = self.axes.T
        return np.ascontiguousarray(local[..., 0:1] * a + local[..., 1:2] * b + local[..., 2:3] * c)

    def local(self, world: Floats) -> Floats:
        """Vectors (..., 3) in world coordinates along the lattice axes."""
        return np.ascontiguousarray(world @ self.axes)

    def position(self, index: Floats) -> Floats:
        """(n, 3) where the control points of (n, 3) indices lie at rest."""
        return self.origin + self.world(index * self.spacing)

    def fitted(self, shape: tuple[int, ...], target: PolygonMesh, path: Path) -> LatticeFrame:
        """The same axes, with the lattice's box around the target's box along them.

        Along an axis in which lattice or target are flat, the mean scale of the others is taken, and the lattice
        is centred.

        Raises
        ------
        InvalidTarget
            No axis in which both extend.
        """
        if not len(target.points):
            raise InvalidTarget(f"{path}: a lattice cannot be fitted to a mesh without points")
        along = target.points @ self.axes
        low, high = along.min(axis=0), along.max(axis=0)
        extent, length = high - low, self.spacing * (np.array(shape) - 1)
        both = (extent > _FLAT * extent.max()) & (length > 0)
        if not both.any():
            raise InvalidTarget(
                f"{path}: a lattice of {' x '.join(map(str, shape))} control points and a mesh of extent "
                f"{extent.tolist()} share no axis in which both extend (use placement='physical')"
            )
        scale = np.divide(extent, length, out=np.ones(3), where=both)
        scale = np.where(both, scale, scale[both].mean())
        middle = (low + high - scale * length) / 2
        return LatticeFrame(self.axes @ np.where(both, low, middle), self.spacing * scale, self.axes)
