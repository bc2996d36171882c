"""NIfTI-1 files, read by nibabel's header and no further than their bytes reach: RAS, millimetres."""

from __future__ import annotations

import gzip
import re
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import MissingExtra, UnreadableFile, UnsupportedFormat
from pliant.io.files import write_bytes
from pliant.io.gzipped import beginning, inflated
from pliant.io.image_formats.image import Image
from pliant.io.image_formats.orientation import split_matrix
from pliant.io.report import LossReport

Floats = NDArray[np.float64]

_SIGNATURE = re.compile(rb"(?s)\A(?:\x5c\x01\x00\x00|\x00\x00\x01\x5c).{340}(n\+1|ni1)\x00")
_HEADER = 348
_VOXELS = 352
_LARGEST = 1 << 40


@dataclass(frozen=True, eq=False)
class Nifti:
    """A NIfTI file.

    Parameters
    ----------
    values
        The voxels, in the shape that the header says.
    matrix
        (4, 4) from indices to positions: the sform, or else the qform.
    header
        nibabel's header.
    """

    values: NDArray[Any]
    matrix: Floats
    header: Any

    @property
    def intent(self) -> tuple[int, bytes, float]:
        """Code, name and first parameter of what the file says that its numbers are."""
        name = bytes(self.header["intent_name"].item()).split(b"\0")[0]
        return int(self.header["intent_code"]), name, float(self.header["intent_p1"])


def is_nifti(head: bytes) -> bool:
    """Whether a file begins as NIfTI-1 does."""
    return _SIGNATURE.match(head) is not None


def read_nifti(path: Path, data: bytes) -> Nifti:
    """The file, compressed or not.

    Raises
    ------
    UnreadableFile
        A header that contradicts itself, fewer voxels than it says, or compression that is damaged.
    UnsupportedFormat
        Header and voxels in two files, or voxels that are no real numbers.
    """
    nib = _nibabel()
    head = beginning(data, _VOXELS)
    if not is_nifti(head):
        raise UnreadableFile(path, "there is no NIfTI header at its beginning", "the file is cut off or damaged")
    if head[344:347] == b"ni1":
        raise UnsupportedFormat(f"{path}: header and voxels stand in two files; save it as one .nii")
    try:
        header = nib.Nifti1Header(head[:_HEADER], check=False)
        shape, kind, begin = header.get_data_shape(), header.get_data_dtype(), int(header["vox_offset"])
        slope, shift = header.get_slope_inter()
        with np.errstate(all="ignore"):
            matrix = np.asarray(header.get_best_affine(), np.float64)
    except (nib.spatialimages.HeaderDataError, ValueError, OverflowError, KeyError) as error:
        raise UnreadableFile(path, f"the NIfTI header is damaged: {error}", "export the file again") from error
    if kind.kind not in "fiu":
        raise UnsupportedFormat(f"{path}: its voxels are of type {kind}; real numbers are needed")
    if not shape or min(shape) < 1 or not _HEADER <= begin < _LARGEST or prod(shape) * kind.itemsize > _LARGEST:
        raise UnreadableFile(path, f"the header says {shape} voxels from byte {begin} on", "the file is damaged")
    needed = begin + prod(shape) * kind.itemsize
    whole = inflated(path, data, needed)
    if len(whole) < needed:
        raise UnreadableFile(path, f"{len(whole):,} bytes; {shape} voxels need {needed:,}", "the file is cut off")
    values = np.frombuffer(whole, kind, prod(shape), begin).reshape(shape, order="F")
    if slope is not None and (slope, shift) != (1.0, 0.0):
        with np.errstate(all="ignore"):
            values = values * slope + shift
    return Nifti(values, matrix, header)


def image_of(path: Path, nifti: Nifti) -> Image:
    """A file as an image of three dimensions, with the numbers of a voxel last.

    Raises
    ------
    UnreadableFile
        Axes that are sheared.
    UnsupportedFormat
        Time and vectors at once.
    """
    shape = (*nifti.values.shape, 1, 1, 1)[:3]
    rest = nifti.values.shape[3:]
    if prod(rest) != max(rest, default=1):
        raise UnsupportedFormat(f"{path}: {nifti.values.shape} voxels; three dimensions, and one more, are read")
    values = nifti.values.reshape((*shape, prod(rest)) if prod(rest) > 1 else shape, order="F")
    return Image(values, *split_matrix(path, nifti.matrix), carrier=nifti.header)


def write_image(image: Image, path: Path) -> LossReport:
    """Write an image; several numbers a voxel become the fourth dimension, as time does."""
    header = image.carrier if isinstance(image.carrier, _nibabel().Nifti1Header) else None
    return LossReport(path, "NIfTI", (), write_nifti(path, image.values, matrix_of(image), header=header))


def matrix_of(image: Image) -> Floats:
    """(4, 4) from indices to positions."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = image.axes * image.spacing, image.origin
    return matrix


def write_nifti(
    path: Path,
    values: NDArray[Any],
    matrix: Floats,
    *,
    intent: tuple[int, bytes, float] | None = None,
    header: Any = None,
) -> tuple[str, ...]:
    """Write voxels; the place of the grid is kept in single precision, which the notes returned say.

    Parameters
    ----------
    path
        Where to; ``.gz`` compresses.
    values
        In NIfTI's order of dimensions.
    matrix
        (4, 4) from indices to positions, RAS.
    intent
        Code, name and first parameter of what the numbers are.
    header
        A header to go on from.
    """
    nib = _nibabel()
    image = nib.Nifti1Image(np.asarray(values), matrix, header)
    image.header.set_data_dtype(values.dtype)
    image.header.set_slope_inter(1, 0)
    image.set_sform(matrix, code=1)
    image.set_qform(matrix, code=1, strip_shears=True)
    image.header.set_xyzt_units("mm")
    if intent is not None:
        image.header["intent_code"], image.header["intent_name"], image.header["intent_p1"] = intent
    data = image.to_bytes()
    write_bytes(path, gzip.compress(data, 6, mtime=0) if path.name.lower().endswith(".gz") else data)
    size = np.array([*values.shape[:3], 1], np.float64)
    stored = np.asarray(image.header.get_sform(), np.float64)
    corners = np.array([[i, j, k, 1.0] for i in (0, size[0]) for j in (0, size[1]) for k in (0, size[2])])
    error = float(np.abs(corners @ (stored - matrix).T).max())
    return (f"the grid's place is stored in single precision: off by {error:.2g} at most",) if error else ()


def _nibabel() -> Any:
    try:
        import nibabel
    except ImportError as error:
        raise MissingExtra("reading and writing NIfTI", "medical") from error
    return nibabel
