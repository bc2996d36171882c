"""Images of medicine: voxels and where they lie, from NIfTI and MetaImage files.

An image is handed out in RAS, millimetres, whatever its file's convention is.
"""

from __future__ import annotations

from pathlib import Path

from pliant.errors import UnsupportedFormat
from pliant.io.files import read_bytes
from pliant.io.gzipped import beginning
from pliant.io.image_formats.image import Image as Image
from pliant.io.report import LossReport


def is_image(data: bytes) -> bool:
    """Whether the bytes of a file, compressed or not, begin as an image that pliant reads."""
    from pliant.io.image_formats import metaimage, nifti

    head = beginning(data, 4096)
    return nifti.is_nifti(head) or metaimage.is_metaimage(head)


def read_image(path: Path | str) -> Image:
    """An image from a NIfTI or MetaImage file, told by its content.

    Parameters
    ----------
    path
        The file: ``.nii``, ``.nii.gz``, ``.mha`` or ``.mhd``; axes are turned to RAS, lengths are millimetres.

    Raises
    ------
    UnreadableFile
        The file is not there, truncated or contradicts itself.
    UnsupportedFormat
        No image that pliant reads.
    MissingExtra
        NIfTI without nibabel.
    """
    from pliant.io.image_formats import metaimage, nifti

    path = Path(path)
    data = read_bytes(path)
    head = beginning(data, 4096)
    if nifti.is_nifti(head):
        return nifti.image_of(path, nifti.read_nifti(path, data))
    if metaimage.is_metaimage(head):
        return metaimage.read(path, data)
    raise UnsupportedFormat(f"{path}: no image that pliant reads (.nii, .nii.gz, .mha, .mhd)")


def write_image(image: Image, path: Path | str) -> LossReport:
    """Write an image to the format that the ending names.

    Parameters
    ----------
    image
        What to write.
    path
        Ends in ``.nii``, ``.nii.gz``, ``.mha`` or ``.mhd``.

    Returns
    -------
    LossReport
        What the format could not hold.

    Raises
    ------
    UnsupportedFormat
        Another ending than .nii, .nii.gz, .mha or .mhd.
    MissingExtra
        NIfTI without nibabel.
    """
    from pliant.io.image_formats import metaimage, nifti

    path = Path(path)
    name = path.name.lower()
    if name.endswith((".nii", ".nii.gz")):
        return nifti.write_image(image, path)
    if name.endswith((".mha", ".mhd")):
        return metaimage.write(image, path)
    raise UnsupportedFormat(f"{path}: no image format that pliant writes (.nii, .nii.gz, .mha, .mhd)")
