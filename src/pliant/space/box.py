"""The box that a lattice lays around a shape."""

from __future__ import annotations

from collections.abc import Sequence
from operator import index

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidDeformer
from pliant.mesh import PolygonMesh
from pliant.space.axes import extent_along, one_number

Floats = NDArray[np.float64]


def box_around(target: PolygonMesh | ArrayLike, axes: Floats, margin: float) -> tuple[Floats, Floats]:
    """The smallest box along some axes that holds a shape, grown by a margin.

    Parameters
    ----------
    target
        A mesh or (n, 3) points.
    axes
        (3, 3) orthonormal axes as columns.
    margin
        How much to add on every side, as a fraction of the box's extent along that axis.

    Returns
    -------
    origin, extent
        (3,) the corner from which all axes point inwards, and (3,) the lengths along the axes. An axis along which
        the shape is flat gets length 0.

    Raises
    ------
    InvalidTarget
        No points.
    InvalidDeformer
        A margin that is no finite number above -0.5.
    """
    low, high = extent_along(target, axes)
    grown = one_number("margin", margin) * (high - low)
    if not (np.isfinite(grown).all() and margin > -0.5):
        raise InvalidDeformer(f"margin is {margin}; it is a part of the box, above -0.5: nothing would be left of it")
    return axes @ (low - grown), high - low + 2 * grown


def checked_counts(shape: Sequence[int], axes: int = 3) -> tuple[int, ...]:
    """Numbers of control points, one for each of some axes.

    Raises
    ------
    InvalidDeformer
        No whole numbers, another number of them, or one below one.
    """
    try:
        counts = tuple(index(count) for count in shape)
    except TypeError as error:
        raise InvalidDeformer(
            f"a lattice's shape is {shape!r}; {axes} whole numbers of control points are needed"
        ) from error
    if len(counts) != axes or min(counts) < 1:
        raise InvalidDeformer(f"a lattice needs at least one control point an axis; its shape is {counts}")
    return counts


def thickened(extent: Floats) -> Floats:
    """Lengths of a box's axes, with the diagonal in place of those that vanish (1 if all do)."""
    diagonal = float(np.linalg.norm(extent))
    return np.where(extent > 1e-12 * diagonal, extent, diagonal or 1.0) if diagonal else np.ones(3)


def checked_axes(axes: ArrayLike | None) -> Floats:
    """(3, 3) orthonormal columns; the identity for None.

    Raises
    ------
    InvalidDeformer
        Columns that are not orthonormal to 1e-6.
    """
    if axes is None:
        return np.eye(3)
    matrix = np.array(axes, np.float64)
    if matrix.shape != (3, 3) or not np.isfinite(matrix).all() or np.abs(matrix.T @ matrix - np.eye(3)).max() > 1e-6:
        raise InvalidDeformer(f"lattice axes must be three orthonormal columns; they are {matrix.tolist()}")
    return matrix
