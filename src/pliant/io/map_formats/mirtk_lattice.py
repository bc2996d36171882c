"""The cubic lattices of MIRTK's files, current and older; and a cursor through big-endian numbers."""

from __future__ import annotations

from math import prod
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.image_formats.orientation import orthonormal
from pliant.io.map_formats.words import require_usable
from pliant.space.bspline_ffd import BSplineFFD, Edge

Floats = NDArray[np.float64]

LATTICES = (76, 56, 12, 4)
"""The types of cubic B-spline lattices of space, the current one first."""

_NO_THIRD_AXIS = 4  # the oldest type: the third axis is the product of the first two
_X_FASTEST = 50  # from this type on
_EXTRAPOLATION = 70  # from this type on, the file says what stands beyond the lattice
_CONSTANT, _NEAREST = 2, 3
_EDGES: dict[int, Edge] = {0: "zero", 1: "zero", _CONSTANT: "zero", _NEAREST: "clamp"}


class Cursor:
    """A place in a file of big-endian numbers."""

    def __init__(self, path: Path, data: bytes) -> None:
        self.path, self._data, self._at = path, data, 0

    def take(self, kind: str, count: int) -> NDArray[np.generic]:
        """The next numbers of a type, which must be there.

        Raises
        ------
        UnreadableFile
            The file ends before.
        """
        code = np.dtype(kind).newbyteorder(">")
        end = self._at + count * code.itemsize
        if end > len(self._data):
            raise self.error(f"the file ends at byte {len(self._data):,}, in the midst of {count:,} numbers")
        values = np.frombuffer(self._data, code, count, self._at)
        self._at = end
        return values

    def numbers(self, count: int, what: str) -> Floats:
        """The next float64 numbers, all finite."""
        return require_usable(self.path, np.asarray(self.take("f8", count), np.float64), what)

    def error(self, cause: str) -> UnreadableFile:
        """What is wrong here."""
        return UnreadableFile(self.path, cause, "the file is cut off or damaged", byte=self._at)


def read_lattice(cursor: Cursor, kind: int, edge: Edge) -> BSplineFFD:
    """The lattice that begins after its type; ``edge`` where the file does not say what stands beyond it.

    Raises
    ------
    UnreadableFile
        Truncated, or a frame that is none.
    UnsupportedFormat
        A lattice that repeats itself beyond its edge.
    """
    nx, ny, nz = (int(n) for n in cursor.take("i4", 3))
    if min(nx, ny, nz) < 1:
        raise cursor.error(f"a lattice of {(nx, ny, nz)} control points")
    axes = np.empty((3, 3))
    count = 2 if kind == _NO_THIRD_AXIS else 3
    axes[:, :count] = cursor.numbers(3 * count, "axes").reshape(count, 3).T
    if count == 2:
        axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    spacing, center = cursor.numbers(3, "spacing"), cursor.numbers(3, "origin")
    spacing = np.where((spacing == 0) & (np.array([nx, ny, nz]) == 1), 1.0, spacing)
    if not (spacing > 0).all():
        raise cursor.error(f"the spacing is {spacing.tolist()}; it must be positive")
    if kind >= _EXTRAPOLATION:
        mode = int(cursor.take("u4", 1)[0])
        if mode not in _EDGES:
            raise UnsupportedFormat(f"{cursor.path}: the lattice goes on periodically or mirrored (mode {mode})")
        edge = _EDGES[mode]
    values = cursor.numbers(3 * prod((nx, ny, nz)), "control points")
    cursor.take("i4", 3 * prod((nx, ny, nz)))  # which of them a registration may move
    if kind >= _X_FASTEST:
        displacements = values.reshape(nz, ny, nx, 3).transpose(2, 1, 0, 3)
    else:
        displacements = values.reshape(nx, ny, nz, 3)
    axes = orthonormal(cursor.path, axes)
    return BSplineFFD(
        displacements=displacements,
        origin=center - axes @ ((np.array([nx, ny, nz]) - 1) / 2 * spacing),
        spacing=spacing,
        axes=axes,
        edge=edge,
        direction="pull-back",
    )


def lattice_bytes(ffd: BSplineFFD) -> bytes:
    """A lattice in the current type's layout, from its size on; every control point free to move."""
    shape = np.array(ffd.shape)
    center = ffd.origin + ffd.axes @ ((shape - 1) / 2 * ffd.spacing)
    frame = np.concatenate([ffd.axes.T.reshape(-1), ffd.spacing, center])
    values = ffd.displacements.transpose(2, 1, 0, 3)
    mode = _NEAREST if ffd.edge == "clamp" else _CONSTANT
    return b"".join(
        [
            shape.astype(">i4").tobytes(),
            frame.astype(">f8").tobytes(),
            np.array(mode, ">u4").tobytes(),
            values.astype(">f8").tobytes(),
            bytes(4 * values.size),
        ]
    )
