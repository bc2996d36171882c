"""Some control points are put somewhere, and others go along so that the joints of patches stay smooth.

``moved_smoothly`` adds to a control point, and to those that keep the joints C1. Where several that belong together are
put somewhere at once, their parts add up: so it is asked for the moves whose sum puts each where it shall be, the least
ones where there are many.
"""

from __future__ import annotations

from typing import TypeGuard

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csc_array, csr_array, hstack

from pliant.errors import InvalidControls, InvalidDeformer
from pliant.mesh import Points
from pliant.space.bezier_ffd import BezierFFD
from pliant.space.extended_ffd import ExtendedFFD
from pliant.space.smooth_joints import joined

_MOST = 1500  # control points that are put somewhere


def has_joints(deformer: object) -> TypeGuard[BezierFFD | ExtendedFFD]:
    """Whether a deformer is made of patches that meet, and knows how to keep them smooth there."""
    if isinstance(deformer, BezierFFD):
        return deformer.patches is not None and max(deformer.patches) > 1
    return isinstance(deformer, ExtendedFFD) and joined(deformer.blocks)


class SmoothDrag:
    """Control points that are put somewhere, and what goes along.

    Parameters
    ----------
    lattice
        Of patches.
    index
        (k,) the control points that are put somewhere, counted through.

    Raises
    ------
    InvalidDeformer
        The lattice has no joints.
    InvalidControls
        A control point that is named twice, or far too many of them.
    """

    def __init__(self, lattice: object, index: NDArray[np.integer]) -> None:
        if not has_joints(lattice):
            raise InvalidDeformer("the lattice has no joints between patches: move its control points as they are")
        if len(np.unique(index)) != len(index) or len(index) > _MOST:
            raise InvalidControls(f"{len(index)} control points are put somewhere: name at most {_MOST}, and each once")
        self._start = np.array(lattice.controls).reshape(-1, 3)
        self._index = np.asarray(index, np.int64)
        columns = [_shares(lattice, int(place), self._start) for place in self._index]
        self._shares = csr_array(hstack(columns))
        self._moves = np.linalg.pinv(self._shares[self._index].toarray(), rcond=1e-9)

    def controls(self, positions: ArrayLike) -> Points:
        """(n, 3) all control points, those of the index being at (k, 3) positions."""
        wanted = np.asarray(positions, np.float64)
        if wanted.shape != (len(self._index), 3):
            raise InvalidControls(f"positions have shape {wanted.shape}; ({len(self._index)}, 3) is needed")
        result: Points = self._start + self._shares @ (self._moves @ (wanted - self._start[self._index]))
        result[self._index] = wanted  # to the last bit
        return result


def _shares(lattice: BezierFFD | ExtendedFFD, place: int, start: Points) -> csc_array:
    """(n, 1) the shares of a control point's move that all take."""
    step = np.array([1.0, 0.0, 0.0])
    if isinstance(lattice, ExtendedFFD):
        moved = lattice.moved_smoothly({place: step}).controls
    else:
        i, j, k = (int(each) for each in np.unravel_index(place, lattice.rest.shape[:3]))
        moved = lattice.moved_smoothly({(i, j, k): step}).controls
    return csc_array((moved.reshape(-1, 3) - start)[:, :1])
