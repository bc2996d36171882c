"""MetaImage files, ``.mha`` and ``.mhd``: text that describes, then voxels, first index fastest; LPS, millimetres."""

from __future__ import annotations

import re
import zlib
from collections.abc import Mapping
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.files import read_bytes, write_bytes
from pliant.io.image_formats.image import Image
from pliant.io.image_formats.orientation import orthonormal
from pliant.io.map_formats.anatomy import SIGNS
from pliant.io.map_formats.words import numbers, spaced
from pliant.io.report import LossReport

Floats = NDArray[np.float64]

_SIGNATURE = re.compile(rb"\A\s*(ObjectType\s*=\s*Image|NDims\s*=)")
_TYPES = {
    "MET_CHAR": "i1",
    "MET_UCHAR": "u1",
    "MET_SHORT": "i2",
    "MET_USHORT": "u2",
    "MET_INT": "i4",
    "MET_UINT": "u4",
    "MET_LONG_LONG": "i8",
    "MET_ULONG_LONG": "u8",
    "MET_FLOAT": "f4",
    "MET_DOUBLE": "f8",
}
_MOST_LINES = 200
_LARGEST = 1 << 40


def is_metaimage(head: bytes) -> bool:
    """Whether a file begins as a MetaImage does."""
    return _SIGNATURE.match(head) is not None


def read(path: Path, data: bytes) -> Image:
    """The image, in RAS.

    Raises
    ------
    UnreadableFile
        A header that contradicts itself, or fewer voxels than it says.
    UnsupportedFormat
        Not three dimensions, voxels in many files, or of a type that is none of MetaImage's.
    """
    header, begin = _header(path, data)
    if header.get("NDims") != "3":
        raise UnsupportedFormat(f"{path}: an image of {header.get('NDims')} dimensions; 3 are read")
    kind, channels = _kind(path, header)
    shape = _field(path, header, "DimSize", 3)
    count = channels * prod(int(n) for n in np.clip(shape, 0, 1e9))
    if not ((shape >= 1) & (shape == np.round(shape))).all() or not 0 < count * kind.itemsize < _LARGEST:
        raise UnreadableFile(path, f"the size is {shape.tolist()}, {channels} numbers each", "the file is damaged")
    raw = _voxels(path, header, data[begin:], count * kind.itemsize)
    nx, ny, nz = (int(n) for n in shape)
    values = np.frombuffer(raw, kind, count).reshape(nz, ny, nx, channels).transpose(2, 1, 0, 3)
    spacing = np.abs(_field(path, header, "ElementSpacing", 3, np.ones(3)))
    if not (spacing > 0).all():
        raise UnreadableFile(path, f"the spacing is {spacing.tolist()}; it must not be zero")
    name = next((word for word in ("TransformMatrix", "Orientation", "Rotation") if word in header), "TransformMatrix")
    axes = orthonormal(path, _field(path, header, name, 9, np.eye(3).reshape(-1)).reshape(3, 3).T)
    place = next((word for word in ("Offset", "Position", "Origin") if word in header), "Offset")
    origin = _field(path, header, place, 3, np.zeros(3))
    return Image(values if channels > 1 else values[..., 0], origin * SIGNS, spacing, SIGNS[:, None] * axes)


def _header(path: Path, data: bytes) -> tuple[dict[str, str], int]:
    """Fields by name, and where the voxels begin."""
    header: dict[str, str] = {}
    begin = 0
    while begin < len(data):
        end = data.find(b"\n", begin, begin + 4096)
        end = len(data) if end < 0 else end
        name, equals, value = data[begin:end].decode("latin-1").partition("=")
        begin = end + 1
        if not name.strip():
            continue
        if not equals or len(header) > _MOST_LINES:
            line = data.count(b"\n", 0, end) + 1
            raise UnreadableFile(path, f"{name[:40]!r} is no field of a MetaImage header", "is it damaged?", line=line)
        header[name.strip()] = value.strip()
        if name.strip() == "ElementDataFile":
            return header, begin
    raise UnreadableFile(path, "the header has no ElementDataFile", "the file is cut off")


def _kind(path: Path, header: Mapping[str, str]) -> tuple[np.dtype[Any], int]:
    """The type of a number, and how many there are in a voxel."""
    kind, channels = header.get("ElementType", ""), header.get("ElementNumberOfChannels", "1")
    if kind not in _TYPES or header.get("BinaryData", "True").lower() != "true":
        raise UnsupportedFormat(f"{path}: voxels of type {kind!r}; binary {', '.join(_TYPES)} are read")
    if not channels.isdecimal() or not 0 < int(channels) < 1000:
        raise UnreadableFile(path, f"a voxel is said to have {channels!r} numbers", "the file is damaged")
    swapped = "true" in (header.get(word, "").lower() for word in ("BinaryDataByteOrderMSB", "ElementByteOrderMSB"))
    return np.dtype(_TYPES[kind]).newbyteorder(">" if swapped else "<"), int(channels)


def _field(path: Path, header: Mapping[str, str], name: str, count: int, default: Floats | None = None) -> Floats:
    if name not in header:
        if default is None:
            raise UnreadableFile(path, f"the header has no {name}", "the file is damaged")
        return default
    line = list(header).index(name) + 1
    return numbers(path, header[name].encode("latin-1"), line, what=name, count=count)


def _voxels(path: Path, header: Mapping[str, str], rest: bytes, size: int) -> bytes:
    """So many bytes of voxels: what follows the header, or a file beside it."""
    name = header["ElementDataFile"]
    if name.upper() != "LOCAL":
        if "%" in name or name.upper().startswith("LIST"):
            raise UnsupportedFormat(f"{path}: its voxels stand in many files; save it as .mha")
        if not name or Path(name).name != name:
            raise UnreadableFile(path, f"its voxels are in {name!r}, not beside it", "put both into one folder")
        rest = read_bytes(path.with_name(name))
    if header.get("CompressedData", "False").lower() == "true":
        try:
            rest = zlib.decompressobj().decompress(rest, size)
        except zlib.error as error:
            raise UnreadableFile(path, f"the compressed voxels are damaged: {error}", "copy the file again") from error
    elif (skip := header.get("HeaderSize", "0")) == "-1" and len(rest) >= size:
        rest = rest[len(rest) - size :]
    elif skip.isdecimal():
        rest = rest[int(skip) :] if name.upper() != "LOCAL" else rest
    if len(rest) < size:
        raise UnreadableFile(path, f"{len(rest):,} bytes of voxels; {size:,} are needed", "the file is cut off")
    return rest[:size]


def write(image: Image, path: Path) -> LossReport:
    """Write an image: ``.mha`` in one file, ``.mhd`` with the voxels in a ``.raw`` beside it.

    Raises
    ------
    UnsupportedFormat
        Numbers of a type that MetaImage does not have.
    """
    little = image.values.dtype.newbyteorder("<")
    kind = next((name for name, code in _TYPES.items() if np.dtype(code) == np.dtype(image.values.dtype.name)), None)
    if kind is None:
        raise UnsupportedFormat(f"{path}: MetaImage has no type for {image.values.dtype}")
    apart = path.suffix.lower() == ".mhd"
    channels = image.values.shape[3] if image.values.ndim == 4 else 1
    place = path.with_suffix(".raw").name if apart else "LOCAL"
    header = (
        b"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
        b"TransformMatrix = " + spaced((SIGNS[:, None] * image.axes).T.reshape(-1)) + b"\n"
        b"Offset = " + spaced(image.origin * SIGNS) + b"\nCenterOfRotation = 0 0 0\nAnatomicalOrientation = RAI\n"
        b"ElementSpacing = " + spaced(image.spacing) + b"\nDimSize = %d %d %d\n" % image.shape
    )
    header += b"ElementNumberOfChannels = %d\n" % channels if channels > 1 else b""
    header += b"ElementType = %s\nElementDataFile = %s\n" % (kind.encode(), place.encode())
    order = (2, 1, 0, 3)[: image.values.ndim]
    voxels = np.ascontiguousarray(image.values.transpose(order), little).tobytes()
    if apart:
        write_bytes(path.with_name(place), [voxels])
    write_bytes(path, [header] if apart else [header, voxels])
    return LossReport(path, "MetaImage")
