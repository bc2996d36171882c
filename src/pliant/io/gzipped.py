"""Compressed files, inflated no further than their contents can be."""

from __future__ import annotations

import zlib
from pathlib import Path

from pliant.errors import UnreadableFile

_MAGIC = b"\x1f\x8b"
_GZIP = 31  # zlib's word for: gzip, the largest window


def is_gzipped(data: bytes) -> bool:
    """Whether bytes begin as a gzip file does."""
    return data.startswith(_MAGIC)


def beginning(data: bytes, count: int) -> bytes:
    """The first bytes of what a file holds, compressed or not; as far as they can be had."""
    if not is_gzipped(data):
        return data[:count]
    try:
        return zlib.decompressobj(_GZIP).decompress(data[: 4 * count + 1024], count)
    except zlib.error:
        return b""


def inflated(path: Path, data: bytes, most: int) -> bytes:
    """What a file holds, compressed or not.

    Parameters
    ----------
    path
        The file, for messages.
    data
        Its bytes.
    most
        How many bytes it can hold at most; a file that goes on is cut there.

    Raises
    ------
    UnreadableFile
        Truncated or damaged compression.
    """
    if not is_gzipped(data):
        return data
    stream = zlib.decompressobj(_GZIP)
    try:
        whole = stream.decompress(data, most)
    except zlib.error as error:
        raise UnreadableFile(path, f"the compressed data is damaged: {error}", "copy or download it again") from error
    if not stream.eof and len(whole) < most:
        raise UnreadableFile(path, "the compressed data is cut off", "copy or download it again", byte=len(data))
    return whole
