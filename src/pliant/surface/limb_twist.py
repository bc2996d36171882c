"""How a limb is twisted about itself: each vertex by its part of the handle's angle, about the limb's middle there.

The angle grows evenly with the distance along the surface, from 0 at the region's fixed edge to 1 at the handle, where
the axis is the line from the edge's mean to the handle's. On the way there it leans towards the line from the edge to
the limb's middle, so that limbs with a joint are twisted along themselves.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points
from pliant.numerics.rigid.rotations import rotations_of

Floats = NDArray[np.float64]

_LEAN = 0.25  # how much of the limb's direction is in that of each place


@dataclass(frozen=True, eq=False)
class LimbTwist:
    """A twist of one radian at the handle.

    Parameters
    ----------
    axis
        (3,) the limb's direction, of length one; zero where the handle is at the edge.
    vectors
        (m, 3) the rotation vectors of the vertices that move.
    arms
        (m, 3) those vertices, each measured from the limb's middle.
    """

    axis: Floats
    vectors: Floats
    arms: Points

    @classmethod
    def along(cls, points: Points, centers: Points, parts: Floats, edge: Points, handle: Points) -> Self:
        """The twist of a limb.

        Parameters
        ----------
        points
            (m, 3) the vertices that move.
        centers
            (m, 3) the limb's middle at each; the handle's mean from the handle on.
        parts
            (m,) of the angle: 0 at the fixed edge, 1 from the handle on.
        edge, handle
            (3,) the means of the fixed edge and of the handle.
        """
        axes = _directions(centers - edge + _LEAN * (handle - edge))  # beside the edge the middle has no direction
        return cls(_directions((handle - edge)[None])[0], parts[:, None] * axes, points - centers)

    def displacements(self, angle: Any) -> NDArray[Any]:
        """(m, 3) for an angle of the handle in radians, real or complex."""
        turned = np.einsum("mij,mj->mi", rotations_of(angle * self.vectors), self.arms)
        return np.asarray(turned - self.arms)


def _directions(vectors: Floats) -> Floats:
    """(k, 3) of length one; zero where there is none."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.where(length == 0, 1.0, length))
