"""What lattices have in common that are kept as displacements of their control points."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Self, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Controls, SpaceDeformer, checked_controls
from pliant.numerics.ragged import frozen

Floats = NDArray[np.float64]


class ControlLattice(SpaceDeformer):
    """A frozen dataclass with a field ``displacements``, (nx, ny, nz, 3), from its rest."""

    displacements: Controls

    @property
    def shape(self) -> tuple[int, int, int]:
        """Numbers of control points along each axis."""
        x, y, z = self.displacements.shape[:3]
        return x, y, z

    @property
    def controls(self) -> Controls:
        return self.rest + self.displacements

    def moved(self, controls: ArrayLike) -> Self:
        displacements = checked_controls(controls, self.rest.shape) - self.rest
        return cast("Self", replace(cast("Any", self), displacements=displacements))


def spaced(shape: tuple[int, int, int], origin: Floats, spacing: Floats, axes: Floats) -> Controls:
    """(nx, ny, nz, 3) the nodes of a grid; ``axes`` has orthonormal columns."""
    index = np.stack(np.meshgrid(*(np.arange(n) for n in shape), indexing="ij"), axis=-1)
    return frozen(origin + (index * spacing) @ axes.T, np.float64)


def spread(shape: tuple[int, int, int], origin: Floats, edges: Floats) -> Controls:
    """(nx, ny, nz, 3) points evenly spread over a parallelepiped; one alone along an edge stands in its middle."""
    steps = [np.linspace(0, 1, n) if n > 1 else np.array([0.5]) for n in shape]
    places = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1)
    return frozen(origin + places @ edges.T, np.float64)
