"""zxhproj ``.AFF``: an affine map as a 4 x 4 matrix and the parameters that it was made of.

The matrix is authoritative. The parameters are kept; where the matrix was changed since, they are written anew: a
rotation as its angles (R = Rx(-a) Ry(-b) Rz(-c), degrees) about the origin, any other matrix as a translation only.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer
from pliant.errors import InvalidParameter, UnsupportedFormat
from pliant.io.files import write_bytes
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.io.map_formats.zxhproj_header import AFFHeader
from pliant.io.map_formats.zxhproj_text import read_blocks, required
from pliant.io.report import LossReport, refuse_losses
from pliant.space.affine import Affine

Floats = NDArray[np.float64]

_DECIMALS = 6
_COARSE = 1e-4  # rounding above this part of a matrix entry's own size is a loss, not a remark
_SKEWS = ("skew in x-y and y-x plane", "skew in y-z and z-y plane", "skew in z-x and x-z plane")


def read(path: Path, data: bytes, options: ReadOptions) -> Affine:
    """The affine map of a file.

    Raises
    ------
    InvalidParameter
        ``placement="fit"``: the map has no box that could be laid around a mesh.
    """
    if options.placement == "fit":
        raise InvalidParameter(f"{path}: an affine map has no lattice to fit to a mesh: use placement='physical'")
    blocks = read_blocks(path, data)
    block = required(path, blocks, "matrix")
    matrix = block.numbers(16).reshape(4, 4)
    if not (matrix[3] == (0, 0, 0, 1)).all():
        raise block.error(f"the last row of the matrix is {matrix[3].tolist()}; an affine map has 0 0 0 1")
    parameters = {name: other.text for name, other in blocks.items() if name != "matrix"}
    return Affine(matrix, "pull-back", AFFHeader(matrix, parameters, data))


def write(deformer: Deformer, path: Path, *, strict: bool) -> LossReport:
    """Write an affine map; one that was read and not changed gives the very same file.

    Raises
    ------
    UnsupportedFormat
        Another deformer.
    """
    if not isinstance(deformer, Affine):
        kind = type(deformer).__name__
        raise UnsupportedFormat(f"{path}: an .AFF file holds an affine map, not a {kind} (a B-spline lattice: .FFD)")
    header = deformer.carrier if isinstance(deformer.carrier, AFFHeader) else None
    direction = () if deformer.direction == "pull-back" else (_direction_note(deformer.direction),)
    if header is not None and (header.matrix == deformer.matrix).all():
        write_bytes(path, header.data)
        return LossReport(path, "zxhproj AFF", (), direction)
    losses, notes = _remarks(deformer)
    refuse_losses(losses, path, strict=strict)
    one_to_one = header.parameters.get("one to one", "1") if header else "1"
    write_bytes(path, _text(deformer, one_to_one).encode("latin-1"))
    return LossReport(path, "zxhproj AFF", losses, direction + notes)


def _remarks(deformer: Affine) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Losses and notes."""
    error = float(np.abs(np.round(deformer.matrix, _DECIMALS) - deformer.matrix).max())
    rounding = (f"the matrix is rounded to six decimals: its numbers are off by {error:.2g} at most",)
    notes: tuple[str, ...] = ()
    if not _is_rotation(deformer.linear):
        notes = ("the matrix holds the whole map; the parameters beside it name its translation only",)
    if error > _COARSE * float(np.abs(deformer.linear).max()):
        return rounding, notes
    return (), (rounding if error else ()) + notes


def _direction_note(direction: str) -> str:
    return f"the direction, {direction!r}, is not stored: readers take the map as 'pull-back'"


def _text(deformer: Affine, one_to_one: str) -> str:
    angles = _angles(deformer.linear) if _is_rotation(deformer.linear) else np.zeros(3)
    text = f"#dimension#\n3\n#one to one#\n{one_to_one}\n"
    for name, values in (
        ("rotation center", np.zeros(3)),
        ("rotation angle", angles),
        ("scaling", np.ones(3)),
        ("translation", deformer.offset),
    ):
        text += f"#{name}#\n{_row(values)}"
    text += "".join(f"#{name}#\n0.000000\n0.000000\n" for name in _SKEWS)
    return text + "#matrix#\n" + "".join(map(_row, deformer.matrix))


def _row(values: Floats) -> str:
    return "".join(f"{value:f}\t" for value in values) + "\n"


def _is_rotation(linear: Floats) -> bool:
    return bool(np.abs(linear @ linear.T - np.eye(3)).max() < 10.0**-_DECIMALS and np.linalg.det(linear) > 0)


def _angles(linear: Floats) -> Floats:
    """(3,) degrees a, b, c of R = Rx(-a) Ry(-b) Rz(-c)."""
    b = np.arctan2(linear[0, 2], np.hypot(linear[0, 0], linear[0, 1]))
    if abs(linear[0, 2]) > 1 - 1e-12:  # x and z turn about the same axis: all of it is given to z
        return -np.degrees([0.0, b, np.arctan2(linear[1, 0], linear[1, 1])])
    a = np.arctan2(-linear[1, 2], linear[2, 2])
    c = np.arctan2(-linear[0, 1], linear[0, 0])
    return -np.degrees([a, b, c])
