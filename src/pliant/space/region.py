"""Where a deformer is at work: the box of its lattice."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.space.box import box_around, thickened
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.compose import Composition
from pliant.space.displacement_grid import DisplacementGrid
from pliant.space.inverse import Inverse
from pliant.space.summed import Summed

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Region:
    """A box.

    Parameters
    ----------
    origin
        (3,) a corner.
    edges
        (3, 3) its columns are the edges that begin there, at right angles.
    """

    origin: Floats
    edges: Floats

    @classmethod
    def around(cls, target: PolygonMesh | ArrayLike) -> Self:
        """The bounding box of a mesh or points."""
        origin, extent = box_around(target, np.eye(3), 0.0)
        return cls(origin, np.diag(thickened(extent)))

    def points(self, parameters: Floats) -> Floats:
        """(n, 3) positions from places in the unit cube."""
        return np.asarray(self.origin + parameters @ self.edges.T)

    def frame(self) -> tuple[Floats, Floats]:
        """The axes, as orthonormal columns, and the lengths of the edges."""
        lengths = np.linalg.norm(self.edges, axis=0)
        return self.edges / lengths, lengths


def region_of(deformer: SpaceDeformer) -> tuple[Region, tuple[int, int, int]]:
    """The box in which a deformer's lattice has its say, and the lattice's numbers of control points.

    That of a composition or a sum is that of its first lattice, that of an inverse the lattice's own.

    Raises
    ------
    InvalidParameter
        No lattice at right angles, hence no box of its own.
    """
    if isinstance(deformer, Inverse):
        return region_of(deformer.deformer)
    if isinstance(deformer, Composition | Summed):
        for part in deformer.deformers:
            if part.rest.ndim == 4:
                return region_of(part)
    rest = deformer.rest
    if rest.ndim == 4 and min(rest.shape[:3]) > 1:
        steps = [rest[1, 0, 0] - rest[0, 0, 0], rest[0, 1, 0] - rest[0, 0, 0], rest[0, 0, 1] - rest[0, 0, 0]]
        spacing = np.stack(steps, axis=1)
        counts = np.array(rest.shape[:3])
        first = 1 if isinstance(deformer, BSplineFFD) and deformer.edge == "identity" else 0
        edges = spacing * (counts - 1 - 2 * first)
        if (
            np.abs(spacing.T @ spacing - np.diag(np.diag(spacing.T @ spacing))).max()
            < 1e-6 * np.abs(spacing).max() ** 2
        ):
            nx, ny, nz = rest.shape[:3]
            return Region(rest[0, 0, 0] + first * spacing.sum(axis=1), edges), (nx, ny, nz)
    raise InvalidParameter(
        f"a {type(deformer).__name__} has no box of its own: say where it is to be sampled (around=, --around)"
    )


def continued(deformer: SpaceDeformer) -> SpaceDeformer:
    """The same map where it is at work, without a jump at its border: outside, it goes on."""
    if isinstance(deformer, BSplineFFD) and deformer.edge == "identity":
        return replace(deformer, edge="clamp")
    if isinstance(deformer, DisplacementGrid) and deformer.outside == "identity":
        return replace(deformer, outside="clamp")
    if isinstance(deformer, Composition | Summed):
        return replace(deformer, deformers=tuple(continued(part) for part in deformer.deformers))
    return deformer
