"""NiftyReg's affine maps: a 4 x 4 matrix as text, RAS, from the reference image to the floating one (pull-back)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.files import write_bytes
from pliant.io.map_formats.displacement_images import NOTE
from pliant.io.map_formats.file_facts import FileFacts
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.io.map_formats.words import numbers, spaced
from pliant.io.report import LossReport, refuse_losses
from pliant.space.affine import Affine

NAME = "NiftyReg affine"


def read(path: Path, data: bytes, options: ReadOptions) -> SpaceDeformer:
    """The map of a file.

    Raises
    ------
    UnreadableFile
        No sixteen numbers, or another last row than 0 0 0 1.
    """
    options.require_physical(path)
    matrix = numbers(path, data.replace(b",", b" "), 1, what="matrix", count=16).reshape(4, 4)
    if not np.array_equal(matrix[3], [0, 0, 0, 1]):
        raise UnreadableFile(path, f"the last row is {matrix[3].tolist()}; an affine map has 0 0 0 1", line=4)
    return Affine(matrix, "pull-back", FileFacts(NAME))


def write(deformer: Deformer, path: Path, *, strict: bool) -> LossReport:
    """Write an affine map.

    Raises
    ------
    UnsupportedFormat
        Another deformer.
    """
    if not isinstance(deformer, Affine):
        raise UnsupportedFormat(f"{path}: the file holds an affine map, not a {type(deformer).__name__}")
    refuse_losses((), path, strict=strict)  # an affine map loses nothing
    write_bytes(path, b"".join(spaced(row) + b"\n" for row in deformer.matrix))
    return LossReport(path, NAME, (), () if deformer.direction == "pull-back" else (NOTE,))
