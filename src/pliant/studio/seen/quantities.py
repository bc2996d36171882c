"""What a surface is coloured by: numbers at its vertices, their ends, and the colours from low to high."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer
from pliant.errors import InvalidParameter
from pliant.field.measures import principal_strains, volume_ratio
from pliant.mesh import PolygonMesh
from pliant.rendering.palette import DIVERGING, SEQUENTIAL, Stops, color_table

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Quantity:
    """A number at each vertex.

    Parameters
    ----------
    values
        What computes it, from the mesh before and after and from what lies between.
    unit
        ``"Length"``, ``"Degrees"`` or ``"None"``.
    about
        The value in the middle of the colours, where they diverge; None where they run from low to high.
    """

    values: Callable[[PolygonMesh, PolygonMesh, Deformer], Floats]
    unit: str = "None"
    about: float | None = None

    def limits(self, values: Floats) -> tuple[float, float]:
        """The ends of the colours: those of the values, never the same."""
        low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
        if self.about is not None:
            reach = max(high - self.about, self.about - low, 1e-6)
            return self.about - reach, self.about + reach
        return low, high if high > low else low + max(abs(low), 1.0) * 1e-6

    @property
    def table(self) -> NDArray[np.uint8]:
        """(256, 3) colours from low to high."""
        stops: Stops = SEQUENTIAL if self.about is None else DIVERGING
        return np.asarray(np.rint(255 * color_table(stops)), np.uint8)


def quantity(name: str) -> Quantity:
    """A quantity by its name.

    Raises
    ------
    InvalidParameter
        There is none of that name.
    """
    if name not in QUANTITIES:
        raise InvalidParameter(f"nothing to colour by is called {name!r}; there are: {', '.join(QUANTITIES)}")
    return QUANTITIES[name]


def _length(before: PolygonMesh, after: PolygonMesh, _: Deformer) -> Floats:
    return np.asarray(np.linalg.norm(after.points - before.points, axis=1))


def _component(axis: int) -> Callable[[PolygonMesh, PolygonMesh, Deformer], Floats]:
    return lambda before, after, _: after.points[:, axis] - before.points[:, axis]


def _ratio(before: PolygonMesh, _: PolygonMesh, deformer: Deformer) -> Floats:
    return volume_ratio(deformer, before)


def _strain(before: PolygonMesh, _: PolygonMesh, deformer: Deformer) -> Floats:
    strains = principal_strains(deformer, before)
    return np.asarray(np.abs(strains).max(axis=1))


def _turning(before: PolygonMesh, after: PolygonMesh, _: Deformer) -> Floats:
    """The angle between the surface's normals before and after, in degrees."""
    cosine = np.einsum("ij,ij->i", before.vertex_normals, after.vertex_normals)
    sine = np.linalg.norm(np.cross(before.vertex_normals, after.vertex_normals), axis=1)
    return np.asarray(np.degrees(np.arctan2(sine, cosine)))


QUANTITIES = {
    "displacement": Quantity(_length, "Length"),
    "x": Quantity(_component(0), "Length", about=0.0),
    "y": Quantity(_component(1), "Length", about=0.0),
    "z": Quantity(_component(2), "Length", about=0.0),
    "volume ratio": Quantity(_ratio, about=1.0),
    "strain": Quantity(_strain),
    "normal": Quantity(_turning, "Degrees"),
}
