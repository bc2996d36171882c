"""The elements of an OBJ file: rows of corners, each of which names up to three numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.io.mesh_formats.format import Source
from pliant.io.text import Lines, Offsets, count_words


def parse_elements(source: Source, lines: Lines) -> tuple[NDArray[np.int32], Offsets, Offsets]:
    """(c, 3) the indices of faces as they stand, 0 where there is none; where the normals' stand; the offsets."""
    from pliant.io.text_kernels import parse_corners
    from pliant.numerics.compute.chunks import for_chunks

    counts = count_words(source, lines)
    require_numbers(source, lines, counts, 1, "face or line")
    offsets = np.concatenate([[0], np.cumsum(counts)])
    table, normals = np.empty((offsets[-1], 3), np.int32), np.empty(offsets[-1], np.int64)
    wrong: list[int] = []

    def work(first: int, stop: int) -> None:
        wrong.append(parse_corners(lines.octets, lines.body, lines.end, offsets, first, stop, table, normals))

    for_chunks(work, len(lines))
    if any(at >= 0 for at in wrong):
        at = min(at for at in wrong if at >= 0)
        word = lines.text[at : at + 40].split()[0]
        raise source.unreadable(f"{word!r} is no corner of a face", "v, v/vt, v//vn or v/vt/vn is needed", at=at)
    return table, normals, offsets


def require_numbers(source: Source, lines: Lines, counts: Offsets, least: int, what: str) -> None:
    """Insist that lines hold at least so many numbers.

    Raises
    ------
    UnreadableFile
        One holds fewer, with its line.
    """
    short = np.flatnonzero(counts < least)
    if len(short):
        cause = f"a {what} has {counts[short[0]]} numbers; {least} are needed"
        raise source.unreadable(cause, "complete or remove the line", at=int(lines.start[short[0]]))
