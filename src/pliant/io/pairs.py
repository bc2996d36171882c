"""Pairs of indices as text: markers of two meshes, and which of their triangles belong together."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidParameter, UnreadableFile
from pliant.io.files import read_bytes, write_bytes


def read_pairs(path: Path | str) -> NDArray[np.int64]:
    """(k, 2) pairs of indices, one pair a line, separated by a comma or blanks, counted from 0.

    A first line that holds one number is the count of pairs. ``#`` begins a comment.

    Parameters
    ----------
    path
        The file; markers of :class:`~pliant.surface.transfer.DeformationTransfer` are such pairs.

    Raises
    ------
    UnreadableFile
        A line that holds no pair, or another number of pairs than the count says.
    """
    pairs: list[tuple[int, int]] = []
    count = None
    for number, line in enumerate(read_bytes(path).decode("utf-8", "replace").splitlines(), 1):
        words = line.partition("#")[0].replace(",", " ").split()
        if not words:
            continue
        if not all(word.isdecimal() and len(word) < 16 for word in words):
            raise UnreadableFile(
                path, f"{line.strip()!r} is no pair of indices", "write two, as in 17, 250", line=number
            )
        if len(words) == 1 and count is None and not pairs:
            count = int(words[0])
        elif len(words) == 2:
            pairs.append((int(words[0]), int(words[1])))
        else:
            raise UnreadableFile(path, f"{line.strip()!r} holds {len(words)} indices", "write two a line", line=number)
    if count is not None and count != len(pairs):
        raise UnreadableFile(
            path, f"the first line says {count} pairs; there are {len(pairs)}", "is the file complete?"
        )
    return np.array(pairs, np.int64).reshape(-1, 2)


def write_pairs(pairs: ArrayLike, path: Path | str) -> None:
    """Write pairs of indices as :func:`read_pairs` reads them.

    Parameters
    ----------
    pairs
        (k, 2) indices, counted from 0.
    path
        Where to; any ending.

    Raises
    ------
    InvalidParameter
        Not pairs of indices.
    """
    array = np.asarray(pairs)
    if array.ndim != 2 or array.shape[1] != 2 or not np.issubdtype(array.dtype, np.integer) or (array < 0).any():
        raise InvalidParameter(f"pairs are (k, 2) indices counted from 0; given: {array.shape} of {array.dtype}")
    lines = [str(len(array)), *(f"{one}, {two}" for one, two in array.tolist())]
    write_bytes(path, ("\n".join(lines) + "\n").encode())
