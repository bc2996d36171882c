"""The plain text of zxhproj files: blocks of numbers under ``#name#`` headers.

Read by tokens, so that white space, CRLF, a byte-order mark, the order of the blocks and a header without its
closing ``#`` do not matter.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnreadableFile

_HEADER = re.compile(rb"#([^#\r\n]*)(?:#|(?=[\r\n])|\Z)")
_MOST_BLOCKS = 64
_LARGEST = 1e100  # products of larger numbers leave float64


@dataclass(frozen=True)
class Block:
    """The text under one header.

    Parameters
    ----------
    path
        The file, for messages.
    name
        The header, in lower case, without the ``#``.
    body
        The bytes up to the next header.
    line
        The line that the body begins on, counted from 1.
    """

    path: Path
    name: str
    body: bytes
    line: int

    @property
    def text(self) -> str:
        """The body on one line, without white space around it."""
        return self.body.strip().decode("latin-1")

    def numbers(self, count: int | None = None) -> NDArray[np.float64]:
        """The numbers of the body.

        Raises
        ------
        UnreadableFile
            A word that is no finite number, or another count than asked for.
        """
        rows = self.rows()
        values = self.floats(rows)
        if count is not None and len(values) != count:
            last = max((at for at, row in enumerate(rows) if row), default=0)
            raise self.error(f"#{self.name}# holds {len(values)} numbers; {count} are expected", line=self.line + last)
        return values

    def integers(self) -> list[int]:
        """The positive whole numbers of the body."""
        values = self.numbers()
        for value in values:
            if value < 1 or value != round(value):
                raise self.error(f"#{self.name}# holds {value:g}; a positive whole number is expected")
        return [int(value) for value in values]

    def rows(self) -> list[list[bytes]]:
        """The words of every line."""
        return [line.split() for line in self.body.split(b"\n")]

    def floats(self, rows: list[list[bytes]]) -> NDArray[np.float64]:
        """The numbers of some :meth:`rows`, one after another."""
        try:
            if b"_" in self.body:
                raise ValueError
            values = np.array([word for row in rows for word in row], np.float64)
        except ValueError:
            values = np.array([np.nan])
        if not (np.abs(values) <= _LARGEST).all():
            at, word = next((at, word) for at, row in enumerate(rows) for word in row if not _is_usable(word))
            found = word[:40].decode("latin-1")
            raise self.error(f"{found!r} is not a finite number, or beyond {_LARGEST:g}", line=self.line + at)
        return values

    def error(self, cause: str, cure: str = "", line: int | None = None) -> UnreadableFile:
        """What is wrong with this block, at its first line that is not blank or at another."""
        if line is None:
            blank = len(self.body) - len(self.body.lstrip())
            line = self.line + self.body.count(b"\n", 0, blank)
        return UnreadableFile(self.path, cause, cure, line=line)


def read_blocks(path: Path, data: bytes) -> Mapping[str, Block]:
    """The blocks of a file by name; a quaternion's header is cut to that word.

    Raises
    ------
    UnreadableFile
        Text before the first header, a header that occurs twice, or far too many of them.
    """
    data = data.removeprefix(b"\xef\xbb\xbf")
    headers = list(_HEADER.finditer(data))[: _MOST_BLOCKS + 1]
    if not headers or len(headers) > _MOST_BLOCKS:
        raise UnreadableFile(path, f"a zxhproj file has 1 to {_MOST_BLOCKS} #headers#; this has {len(headers)} or more")
    if data[: headers[0].start()].strip():
        raise UnreadableFile(path, "there is text before the first #header#", line=1)
    blocks: dict[str, Block] = {}
    ends = [header.start() for header in headers[1:]] + [len(data)]
    for header, end in zip(headers, ends, strict=True):
        name = " ".join(header[1].decode("latin-1").lower().split())
        name = "quaternion" if name.startswith("quaternion") else name
        line = data.count(b"\n", 0, header.end()) + 1
        if name in blocks:
            raise UnreadableFile(path, f"#{name}# occurs twice", "remove one of the blocks", line=line)
        blocks[name] = Block(path, name, data[header.end() : end], line)
    return blocks


def required(path: Path, blocks: Mapping[str, Block], name: str) -> Block:
    """One block.

    Raises
    ------
    UnreadableFile
        It is not there.
    """
    if name not in blocks:
        found = ", ".join(f"#{other}#" for other in blocks)
        raise UnreadableFile(path, f"there is no #{name}# block; there are: {found}", "the file may be truncated")
    return blocks[name]


def _is_usable(word: bytes) -> bool:
    try:
        return b"_" not in word and abs(float(word)) <= _LARGEST
    except ValueError:
        return False
