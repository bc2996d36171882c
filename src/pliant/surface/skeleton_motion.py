"""How a contour skeleton moves with its handle, and takes the details of the surface along.

The skeleton's points s of a region follow the handle, s' = s + f(t) (v_h' - v_h), where t runs from 0 at the region's
fixed edge to 1 at the handle; the details d = v - s are turned, v' = s' + q d q⁻¹. Plainly, all turn about one axis,
(v_h - a) × (v_h' - a) with a on the fixed edge, by an angle that grows from 0 across a band beside the edge. Or each
group turns as the links of the skeleton around it do.

A skeleton's points do not see a limb turn about itself. That angle is given beside the shift, see :class:`LimbTwist`:
vertices are twisted first, and swing then.

All is written for complex numbers too, so that a complex step gives exact derivatives.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points
from pliant.numerics.rigid.rotations import rotations_of, turning_vectors
from pliant.surface.limb_twist import LimbTwist

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class SkeletonMotion:
    """The part of a skeleton that moves.

    Parameters
    ----------
    details
        (m, 3) the moving vertices, each measured from its group's point.
    groups
        (m,) their groups, counted among those that move.
    points
        (g, 3) the groups' points.
    follow
        (g,) f(t): how far each follows the handle; 1 from the handle on.
    turn
        (m,) the part of the full angle by which each vertex is turned.
    parents
        (g,) the group before each on the way to the edge; -1 = the edge itself.
    edge, handle
        (3,) the means of the fixed edge and of the handle.
    by_links
        Whether details turn with the skeleton's links.
    twist
        How the limb is twisted about itself.
    """

    details: Points
    groups: Integers
    points: Points
    follow: Floats
    turn: Floats
    parents: Integers
    edge: Points
    handle: Points
    by_links: bool
    twist: LimbTwist

    def moved(self, shift: NDArray[Any], angle: Any = 0.0) -> tuple[NDArray[Any], NDArray[Any]]:
        """Where the vertices go, and what the twist adds to that.

        Parameters
        ----------
        shift
            (3,) how far the handle's mean moves, real or complex.
        angle
            By how much the handle turns about the limb, likewise.

        Returns
        -------
        tuple
            Both (m, 3): positions, and displacements from them.
        """
        full = turning_vectors((self.handle - self.edge)[None], (self.handle + shift - self.edge)[None])
        carried = self.points + self.follow[:, None] * shift
        beyond = self.follow >= 1  # the handle, and what lies behind it, moves as a rigid body
        swung = (self.points - self.handle) @ rotations_of(full)[0].T
        carried = np.where(beyond[:, None], self.handle + shift + swung, carried)
        vectors = np.broadcast_to(full, self.points.shape)
        if self.by_links:
            vectors = np.where(beyond[:, None], vectors, self._link_turns(carried))
        rotations = rotations_of(self.turn[:, None] * vectors[self.groups])
        positions = carried[self.groups] + np.einsum("mij,mj->mi", rotations, self.details)
        return np.asarray(positions), np.einsum("mij,mj->mi", rotations, self.twist.displacements(angle))

    def _link_turns(self, carried: NDArray[Any]) -> NDArray[Any]:
        """(g, 3) how the links to the group before, and after, each group turn, on average."""
        before = np.vstack([self.points, self.edge])[self.parents]
        after = np.vstack([carried, self.edge])[self.parents]
        vectors = turning_vectors(self.points - before, carried - after)
        has = self.parents >= 0
        sums, count = vectors.copy(), np.ones(len(vectors))
        np.add.at(sums, self.parents[has], vectors[has])
        np.add.at(count, self.parents[has], 1.0)
        return np.asarray(sums / count[:, None])


@dataclass(frozen=True)
class Band:
    """The angular profile that rises smoothly from 0 to 1 across a band beside the edge.

    Parameters
    ----------
    width
        Of the band, as a part of the way from the edge to the handle.
    """

    width: float = 0.3

    def __call__(self, t: Floats) -> Floats:
        """(k,) parts of the angle at (k,) parts of the way."""
        part = np.clip(t / self.width, 0.0, 1.0)
        return np.asarray(part * part * (3 - 2 * part))


def parents_of(links: Integers, along: Floats) -> Integers:
    """(g,) for each group the linked one that comes last before it, ``along`` (g,) telling how far each is; or -1."""
    result = np.full(len(along), -1, np.int64)
    both = np.vstack([links, links[:, ::-1]])
    both = both[along[both[:, 1]] < along[both[:, 0]]]
    both = both[np.argsort(along[both[:, 1]], kind="stable")]
    result[both[:, 0]] = both[:, 1]
    return result
