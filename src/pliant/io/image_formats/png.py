"""Writing PNG with the standard library alone (W3C, Portable Network Graphics, 2003)."""

from __future__ import annotations

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter


def png_bytes(pixels: NDArray[np.uint8]) -> bytes:
    """A PNG file of (height, width, 3) colours; the first row is the top.

    Raises
    ------
    InvalidParameter
        Another shape or type.
    """
    if pixels.dtype != np.uint8 or pixels.ndim != 3 or pixels.shape[2] != 3 or not pixels.size:
        raise InvalidParameter(f"pixels are {pixels.dtype} of shape {pixels.shape}; (height, width, 3) uint8 is needed")
    height, width = pixels.shape[:2]
    filtered = np.hstack([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)])  # filter 0 begins each row
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = (b"IHDR", header), (b"IDAT", zlib.compress(filtered.tobytes(), 9)), (b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, data) for kind, data in chunks)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
