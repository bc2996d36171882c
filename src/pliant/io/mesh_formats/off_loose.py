"""OFF whose vertices and faces do not keep to a line each: only the order of the words counts.

Where they begin and end is found here; rows are then read as if each stood in a line of its own.
"""

from __future__ import annotations

import re

import numpy as np

from pliant.io.mesh_formats.format import Source
from pliant.io.text import Floats, Lines, Offsets, read_numbers

_COMMENT = re.compile(rb"#[^\r\n]*")


def loose_lines(source: Source, text: bytes, begin: int, columns: tuple[int, ...]) -> tuple[int, int, Lines] | None:
    """The counts of vertices and faces and a row for each of them, or None where the words do not add up.

    Parameters
    ----------
    source, text
        The file.
    begin
        Where its header ends.
    columns
        How many numbers a vertex may have, the likeliest first.

    Raises
    ------
    UnreadableFile
        A word that is no number.
    """
    bare = _COMMENT.sub(lambda found: b" " * len(found[0]), text)
    octets = np.frombuffer(bare, np.uint8)[begin:]
    word = np.concatenate([[False], octets > ord(" "), [False]])
    starts = begin + np.flatnonzero(word[1:-1] & ~word[:-2])
    ends = begin + np.flatnonzero(word[1:-1] & ~word[2:]) + 1
    if len(starts) < 3:
        return None
    whole = Lines(bare, starts[:1], starts[:1], ends[-1:], np.zeros(1, np.uint64))
    values = read_numbers(source, whole, len(starts), body=False).values
    vertices, faces = int(values[0]), int(values[1])
    breaks = begin + np.flatnonzero((octets == 10) | (octets == 13))
    line = np.searchsorted(breaks, starts)
    line_end = np.searchsorted(line, line, "right")  # the first word of a later line
    for width in columns:
        first = 3 + width * vertices
        if first > len(values):
            continue
        for to_line_end in (True, False):
            rows = _faces(values, line_end, first, faces, to_line_end=to_line_end)
            if rows is not None:
                begins = np.concatenate([3 + width * np.arange(vertices), rows[:-1]])
                stops = np.concatenate([begins[1:], rows[-1:]]) - 1
                row_starts, row_ends = starts[begins], ends[stops]
                keys = np.zeros(len(begins), np.uint64)
                return vertices, faces, Lines(bare, row_starts, row_starts, row_ends, keys)
    return None


def _faces(values: Floats, line_end: Offsets, first: int, count: int, *, to_line_end: bool) -> Offsets | None:
    """(f + 1,) the word at which each face begins, if they use up all words; colours reach to a line's end."""
    at, total, begins = first, len(values), [first]
    for _ in range(count):
        if at >= total or not 1 <= values[at] < total - at:
            return None
        last = at + int(values[at])
        at = int(line_end[last]) if to_line_end else last + 1
        if at - last > 5:  # a colour has four numbers at most
            return None
        begins.append(at)
    return np.array(begins) if at == total else None
