"""The box that a lattice lays around a shape."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidDeformer
from pliant.mesh import PolygonMesh
from pliant.space.axes import extent_along

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
    """
    low, high = extent_along(target, axes)
    grown = margin * (high - low)
    return axes @ (low - grown), high - low + 2 * grown


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
