"""A lattice with its surroundings written out: for formats in which nothing stands beyond the last control points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.space.bspline_ffd import BSplineFFD

Floats = NDArray[np.float64]

_GOES_ON = (
    "the displacement beyond the lattice: there, farther than one spacing out, nothing moves, but edge='clamp' "
    "repeats the outermost control points"
)
_LAYERS = {"clamp": 2, "zero": 3, "identity": 0}  # that a point just beyond the lattice can reach


def surrounded(ffd: BSplineFFD) -> tuple[Floats, Floats, tuple[str, ...]]:
    """The lattice with the layers of control points that its edge setting implies.

    Returns
    -------
    values
        (x, y, z, 3) displacements along the world's axes.
    origin
        (3,) where the first of them lies.
    losses
        What happens beyond the outermost layers and is not in them.
    """
    shape = np.array(ffd.shape)
    layers = np.where(shape == 1, _LAYERS["clamp"], _LAYERS[ffd.edge])
    width = [(count, count) for count in layers] + [(0, 0)]
    values = np.pad(ffd.displacements, width, mode="edge")
    if ffd.edge == "zero":
        for axis in np.flatnonzero(shape > 1):
            moved = np.moveaxis(values, axis, 0)
            moved[: layers[axis]] = moved[len(moved) - layers[axis] :] = 0.0
    origin = ffd.origin - ffd.axes @ (layers * ffd.spacing)
    if not (layers == _LAYERS["clamp"]).any() or not values.any():
        return values, origin, ()
    return values, origin, (_GOES_ON,)
