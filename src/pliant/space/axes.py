"""Directions, and how far shapes reach along them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidDeformer, InvalidTarget
from pliant.mesh import PolygonMesh, as_points
from pliant.numerics.given import as_number, as_numbers

Floats = NDArray[np.float64]


def one_number(name: str, value: Any) -> float:
    """A finite number.

    Raises
    ------
    InvalidDeformer
        Anything else.
    """
    return as_number(name, value, InvalidDeformer)


def three_numbers(name: str, values: ArrayLike) -> Floats:
    """(3,) finite numbers.

    Raises
    ------
    InvalidDeformer
        Anything else.
    """
    array = as_numbers(name, values, InvalidDeformer)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise InvalidDeformer(f"{name} is {array.tolist()}; three finite numbers are needed")
    return array


def unit_axis(axis: str | ArrayLike, name: str = "axis") -> Floats:
    """(3,) the unit vector of ``"x"``, ``"y"``, ``"z"`` or of a vector of any length.

    Raises
    ------
    InvalidDeformer
        Another name, or a vector without direction.
    """
    if isinstance(axis, str):
        if axis not in ("x", "y", "z"):
            raise InvalidDeformer(f"{axis!r} is no {name}: 'x', 'y', 'z' or three numbers are needed")
        unit: Floats = np.eye(3)["xyz".index(axis)]
        return unit
    vector = three_numbers(name, axis)
    largest = np.abs(vector).max()
    if largest == 0:
        raise InvalidDeformer(f"the {name} {vector.tolist()} has no direction: pass numbers that are not all zero")
    scaled = vector / largest
    return np.asarray(scaled / np.linalg.norm(scaled))


def extent_along(target: PolygonMesh | ArrayLike, axes: Floats) -> tuple[Floats, Floats]:
    """The lowest and the highest position, (k,) each, of a shape along (3, k) axes.

    Raises
    ------
    InvalidTarget
        No points.
    """
    points = as_points(target)
    if not len(points):
        raise InvalidTarget("a deformer cannot be laid around a shape without points")
    along = points @ axes
    return along.min(axis=0), along.max(axis=0)
