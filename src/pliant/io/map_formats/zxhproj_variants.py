"""The four layouts in which zxhproj ``.FFD`` files list their control points, and how to tell them apart.

======= =====================================================================================================
A       genuine: x runs along a row, rows are y, slabs are z
B       z runs along a row, rows are y, slabs are x
C       as A or B, but absolute positions of a Bernstein lattice under a spacing of 1 1 1
D       one point a line, x fastest
======= =====================================================================================================
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Shape = tuple[int, int, int]

_TREND = 0.95  # correlation of a coordinate with its own index from which values look like positions


@dataclass(frozen=True)
class Layout:
    """A variant, why it was taken, and whether that was a guess.

    ``x_first`` says that slabs are of equal x: the order of variant B.
    """

    variant: str
    reason: str
    guessed: bool = False
    x_first: bool = False

    def arrange(self, values: Floats, shape: Shape) -> Floats:
        """(nx, ny, nz, d) from the numbers in file order."""
        if self.x_first:
            return values.reshape(*shape, -1)
        return values.reshape(*shape[::-1], -1).transpose(2, 1, 0, 3)


def order_of(row_lengths: list[int], shape: Shape, genuine_format: bool, complete: bool) -> Layout:
    """Variant A, B or D from how many points each line holds.

    Parameters
    ----------
    row_lengths
        Numbers a line, divided by numbers a point; 0 for a blank line.
    shape
        (nx, ny, nz) as the header has it.
    genuine_format
        Spacing and offsets all carry exactly six decimals.
    complete
        The file also has its quaternion block, as all genuine ones do.
    """
    slabs = [list(group) for filled, group in groupby(row_lengths, key=bool) if filled]
    nx, _, nz = shape
    is_a = _matches(slabs, along=nx, rows=shape[1], count=nz)
    is_b = _matches(slabs, along=nz, rows=shape[1], count=nx)
    if is_a and is_b and nx > 1:
        if genuine_format:
            return Layout("A", "six decimals throughout; rows and slabs fit both A and B", guessed=not complete)
        return Layout("B", "not six decimals throughout; rows and slabs fit both A and B", True, x_first=True)
    if is_a:
        return Layout("A", "rows and slabs")
    if all(length == 1 for slab in slabs for length in slab) and not (is_b and len(slabs) == nx > 1):
        return Layout("D", "one point a line")
    if is_b:
        return Layout("B", "rows and slabs", x_first=True)
    return Layout("A", "rows and slabs fit no variant, though the count does", guessed=True)


def _matches(slabs: list[list[int]], along: int, rows: int, count: int) -> bool:
    """Whether there are ``count`` slabs of ``rows`` lines of ``along`` points; blank lines may be missing."""
    if len(slabs) == 1:
        slabs = [slabs[0][start : start + rows] for start in range(0, len(slabs[0]), rows)]
    return len(slabs) == count and all(slab == [along] * rows for slab in slabs)


def absolute(layout: Layout, values: Floats, shape: Shape, spacing: Floats) -> Layout:
    """Variant C instead, where the spacing is 1 1 1 and each coordinate rises along its own index."""
    if not (spacing == 1).all() or min(shape) < 2 or values.size != 3 * np.prod(shape):
        return layout
    as_positions = positions(layout, values, shape)
    if _trend(as_positions.arrange(values, shape)) < _TREND:
        return layout
    return Layout("C", "spacing 1 1 1 and coordinates that rise with their index", True, as_positions.x_first)


def positions(layout: Layout, values: Floats, shape: Shape) -> Layout:
    """Variant C by the caller's word; where rows and slabs leave the order open, the coordinates' trend decides."""
    x_first = layout.x_first
    if shape[0] == shape[2]:
        orders = [Layout("C", "", x_first=first) for first in (False, True)]
        x_first = orders[int(np.argmax([_trend(order.arrange(values, shape)) for order in orders]))].x_first
    return Layout("C", "as asked for", x_first=x_first)


def _trend(points: Floats) -> float:
    """The smallest correlation of a coordinate with the index along its own axis."""
    least = 1.0
    for axis in range(3):
        index = np.arange(points.shape[axis], dtype=np.float64)
        index -= index.mean()
        coordinate = points[..., axis] - points[..., axis].mean()
        size = np.sqrt((index**2).mean() * (coordinate**2).mean())
        mean = np.moveaxis(coordinate, axis, 0).reshape(len(index), -1).mean(axis=1)
        least = min(least, float((index * mean).mean() / size) if size > 0 else 0.0)
    return least
