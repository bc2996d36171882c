"""Numbers in the text of transform files: finite, and as many as there should be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnreadableFile
from pliant.io.text import number_text

Floats = NDArray[np.float64]

_LARGEST = 1e100  # products of larger numbers leave float64


def numbers(path: Path, text: bytes, line: int, *, what: str, count: int | None = None) -> Floats:
    """The numbers of some text.

    Parameters
    ----------
    path, line
        Where the text begins, for messages.
    text
        Numbers between white space.
    what
        What they are, for messages.
    count
        How many there must be; None = any.

    Raises
    ------
    UnreadableFile
        A word that is no finite number, or another count.
    """
    words = text.split()
    if count is not None and len(words) != count:
        raise UnreadableFile(path, f"{what}: {len(words):,} numbers; {count:,} are expected", _CUT, line=line)
    try:
        values = np.array(words, np.float64) if b"_" not in text else np.array([np.nan])
    except ValueError:
        values = np.array([np.nan])
    if not (np.abs(values) <= _LARGEST).all():
        word = next(word for word in words if not _is_usable(word))[:40].decode("latin-1")
        raise UnreadableFile(path, f"{what}: {word!r} is not a finite number, or beyond {_LARGEST:g}", line=line)
    return values


def require_usable(path: Path, values: Floats, what: str) -> Floats:
    """Binary numbers as float64, if all are finite and none is beyond reason.

    Raises
    ------
    UnreadableFile
        Otherwise, with the count and the first.
    """
    with np.errstate(invalid="ignore"):  # not-a-numbers that signal
        wide = np.asarray(values, np.float64)
    bad = np.flatnonzero(~(np.abs(wide.reshape(-1)) <= _LARGEST))
    if len(bad):
        raise UnreadableFile(
            path,
            f"{what}: {len(bad):,} of {wide.size:,} numbers are not finite, or beyond {_LARGEST:g}",
            f"the first is number {bad[0]:,}: the file is damaged",
        )
    return wide


def spaced(values: Floats) -> bytes:
    """Numbers between blanks, each the shortest that reads back as the same number."""
    return number_text(np.asarray(values, np.float64) + 0.0).replace(b",", b" ")


_CUT = "the file is cut off, or its sizes are wrong"


def _is_usable(word: bytes) -> bool:
    try:
        return b"_" not in word and abs(float(word)) <= _LARGEST
    except ValueError:
        return False
