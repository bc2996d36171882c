"""Whether the parts of a mesh fit together: what it is refused for, with the first place that is wrong."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidMesh
from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.given import as_numbers
from pliant.numerics.ragged import Ragged

Floats = NDArray[np.float64]


def checked_points(points: ArrayLike, *, finite: bool = True) -> Floats:
    """(n, 3) float64 positions; nothing at all is (0, 3).

    Parameters
    ----------
    points
        Anything that reads as an array.
    finite
        Whether to look for coordinates that are not finite.

    Raises
    ------
    InvalidMesh
        Another shape, or a coordinate that is not finite.
    """
    array = as_numbers("points", points, InvalidMesh)
    if array.shape == (0,):
        array = array.reshape(0, 3)
    if array.ndim != 2 or array.shape[1] != 3:
        raise InvalidMesh(f"points have shape {array.shape}; (n, 3) is needed")
    if finite:
        _require_finite(array)
    return array


def checked_rows(rows: Ragged | ArrayLike, kind: str) -> Ragged:
    """Rows of vertex indices, of faces or lines.

    Raises
    ------
    InvalidMesh
        What is given is no rows of whole numbers.
    """
    try:
        return Ragged.of(rows)
    except (TypeError, ValueError, OverflowError) as error:
        raise InvalidMesh(f"the {kind}s are {repr(rows)[:60]}; rows of vertex indices are needed") from error


def _require_finite(points: Floats) -> None:
    sums = []
    with np.errstate(over="ignore", invalid="ignore"):  # one fast pass; an overflow is looked at more closely below
        for_chunks(lambda start, stop: sums.append(points[start:stop].sum()), len(points))
    if np.isfinite(sums).all():
        return
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise InvalidMesh(
            f"{len(bad)} of {len(points):,} points are not finite, the first is point {bad[0]}: {points[bad[0]]}"
        )


def require_vertices(rows: Ragged | None, count: int, kind: str) -> None:
    """Make sure that rows of a kind, faces or lines, use vertices below ``count``.

    Raises
    ------
    InvalidMesh
        With the first that does not.
    """
    if rows is None:
        return
    ends = rows.offsets
    if ends.ndim != 1 or rows.flat.ndim != 1 or not len(ends) or ends[0] or ends[-1] != len(rows.flat):
        raise InvalidMesh(f"the rows of the {kind}s do not make up their {rows.flat.size:,} corners")
    if len(rows) and rows.lengths.min() < 0:
        raise InvalidMesh(f"{kind} {rows.lengths.argmin()} ends before it begins")
    if not rows.flat.size or 0 <= rows.flat.min() <= rows.flat.max() < count:
        return
    at = int(np.flatnonzero((rows.flat < 0) | (rows.flat >= count))[0])
    raise InvalidMesh(f"{kind} {rows.row_of[at]} uses vertex {rows.flat[at]}; there are {count} vertices")


def require_cells(rows: NDArray[Any], count: int, kind: str) -> None:
    """Make sure that the (c, k) cells of a kind use vertices below ``count``.

    Raises
    ------
    InvalidMesh
        They do not, or are of another shape.
    """
    if rows.ndim != 2:
        raise InvalidMesh(f"cells {kind!r} have shape {rows.shape}; one row a cell is needed")
    if rows.size and not 0 <= rows.min() <= rows.max() < count:
        worst = rows.min() if rows.min() < 0 else rows.max()
        raise InvalidMesh(f"a cell of the kind {kind!r} uses vertex {worst}; there are {count} vertices")


def require_length(name: str, values: NDArray[Any], count: int, what: str) -> None:
    """Make sure that values have one row for each of ``count`` vertices, faces or corners.

    Raises
    ------
    InvalidMesh
        They have not.
    """
    if len(values) != count:
        raise InvalidMesh(f"{name} has {len(values)} rows; there are {count} {what}")
