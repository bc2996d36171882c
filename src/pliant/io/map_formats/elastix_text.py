"""The text of elastix's parameter files: ``(Key value value)``, comments after ``//``."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnreadableFile
from pliant.io.map_formats.words import numbers, spaced

Floats = NDArray[np.float64]
Words = dict[str, Sequence[str] | Sequence[int] | Sequence[float]]

_ENTRY = re.compile(rb"\(\s*([A-Za-z]\w*)([^()]*)\)")
_COMMENT = re.compile(rb"//[^\n]*")
_MOST = 10_000


@dataclass(frozen=True)
class Parameters:
    """The entries of a file: the text after each key, and the line that it stands on."""

    path: Path
    entries: Mapping[str, tuple[bytes, int]]

    def text(self, key: str, default: str) -> str:
        """The first word of an entry, without quotation marks."""
        raw, _ = self.entries.get(key, (default.encode(), 0))
        return raw.strip().strip(b'"').decode("utf-8", "replace")

    def numbers(self, key: str, count: int | None = None, default: Floats | None = None) -> Floats:
        """The numbers of an entry.

        Raises
        ------
        UnreadableFile
            It is not there and has no default, or has another count.
        """
        if key not in self.entries:
            if default is None:
                raise UnreadableFile(self.path, f"there is no ({key} ...) in it", "the file is cut off or damaged")
            return default
        raw, line = self.entries[key]
        return numbers(self.path, raw, line, what=key, count=count)

    def line(self, key: str) -> int:
        """Where an entry stands."""
        return self.entries[key][1]

    def error(self, key: str, cause: str) -> UnreadableFile:
        """What is wrong with an entry."""
        return UnreadableFile(self.path, f"{key}: {cause}", "the file is damaged", line=self.line(key))


def parse(path: Path, data: bytes) -> Parameters:
    """The entries of a file.

    Raises
    ------
    UnreadableFile
        No entry, or far too many.
    """
    text = _COMMENT.sub(lambda found: b" " * len(found[0]), data)
    entries: dict[str, tuple[bytes, int]] = {}
    line, at = 1, 0
    for found in _ENTRY.finditer(text):
        line += text.count(b"\n", at, found.start())
        at = found.start()
        entries[found[1].decode("ascii")] = (found[2], line)
        if len(entries) > _MOST:
            raise UnreadableFile(path, f"there are more than {_MOST:,} entries", line=line)
    if not entries:
        raise UnreadableFile(path, "there is no (Key value) in it", "it is no parameter file of elastix")
    return Parameters(path, entries)


def shown(words: Words) -> bytes:
    """Entries as text."""
    return b"".join(b"(" + key.encode() + b" " + _values(values) + b")\n" for key, values in words.items())


def _values(values: Sequence[str] | Sequence[int] | Sequence[float]) -> bytes:
    if isinstance(values[0], str):
        return b" ".join(f'"{value}"'.encode() for value in values)
    if isinstance(values[0], int):
        return b" ".join(b"%d" % int(value) for value in values)
    return spaced(np.array(values, np.float64))
