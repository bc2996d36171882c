"""Which way x and y point in the coordinates of medicine: RAS (right, anterior, superior) or LPS (left, posterior).

pliant hands transforms out in RAS, millimetres, as NIfTI has them. Formats that think in LPS are turned when they are
read and turned back when they are written: a half turn about z, exact.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from pliant.space.affine import Affine
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.displacement_grid import DisplacementGrid

Basic = TypeVar("Basic", Affine, BSplineFFD, DisplacementGrid)

SIGNS = np.array([-1.0, -1.0, 1.0])
"""What each coordinate is multiplied with, from LPS to RAS and from RAS to LPS."""

_TURN = np.diag([*SIGNS, 1.0])


def half_turned(deformer: Basic) -> Basic:
    """The same map in the other convention: F T F, with F the half turn."""
    if isinstance(deformer, Affine):
        return replace(deformer, matrix=_TURN @ deformer.matrix @ _TURN)
    moved = {
        "displacements": deformer.displacements * SIGNS,
        "origin": deformer.origin * SIGNS,
        "axes": SIGNS[:, None] * deformer.axes,
    }
    if isinstance(deformer, BSplineFFD):
        moved["affine"] = _TURN @ deformer.affine @ _TURN
    return replace(deformer, **moved)
