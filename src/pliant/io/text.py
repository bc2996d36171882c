"""Text formats: lines and numbers in, numbers out, and new numbers put where the old ones stood.

Bytes are never decoded as a whole: names keep the bytes that they had, in whatever encoding.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import orjson
from numpy.typing import NDArray

from pliant.io.mesh_formats.format import Source
from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.ragged import Ragged

Floats = NDArray[np.float64]
Offsets = NDArray[np.int64]

_BLANKS = re.compile(rb"[\s#]")
_CONTINUED = re.compile(rb"\\[ \t]*(\r\n|\r|\n)")


def plain_text(source: Source) -> bytes:
    """The file's bytes with marks and line continuations blanked, every byte at its old offset.

    Raises
    ------
    UnreadableFile
        Text of two bytes a character, or no text at all.
    """
    data = source.data
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise source.unreadable("the text is UTF-16", "save it as UTF-8", at=0)
    if data.startswith(b"\xef\xbb\xbf"):
        data = b"   " + data[3:]
    if b"\\" in data:
        data = _CONTINUED.sub(lambda found: _blanked(found, data), data)
    if (at := data.find(b"\0")) >= 0:
        raise source.unreadable("a zero byte in a text file", "export the file again", at=at)
    return data


def _blanked(found: re.Match[bytes], data: bytes) -> bytes:
    """A continuation as blanks, but for one at the end of a comment, which continues nothing."""
    begin = max(data.rfind(b"\n", 0, found.start()), data.rfind(b"\r", 0, found.start())) + 1
    return found[0] if data[begin : found.start()].lstrip().startswith(b"#") else b" " * len(found[0])


def keyword(word: bytes) -> int:
    """A line's first word of up to eight characters as the number that :class:`Lines` knows it by."""
    return int.from_bytes(word.lower(), "little")


def text_of(raw: bytes) -> str:
    """Bytes as a string that gives back the very same bytes in :func:`bytes_of`."""
    return raw.decode("utf-8", "surrogateescape")


def bytes_of(text: str) -> bytes:
    """The bytes that a name had in its file."""
    return text.encode("utf-8", "surrogateescape")


def shown(text: str) -> str:
    """A name fit for messages, whatever its encoding was."""
    return bytes_of(text).decode("utf-8", "replace")


@dataclass(frozen=True, eq=False)
class Lines:
    """Where the lines of a text stand that hold something, comments left out.

    Parameters
    ----------
    text
        The text, as :func:`plain_text` gives it.
    start, body, end
        (k,) offsets of a line's first word, of what follows that word, and of the line's end.
    key
        (k,) each line's first word, see :func:`keyword`.
    """

    text: bytes
    start: Offsets
    body: Offsets
    end: Offsets
    key: NDArray[np.uint64]

    @classmethod
    def of(cls, text: bytes, begin: int = 0) -> Lines:
        """The lines from an offset on."""
        from pliant.io.text_kernels import split_lines

        data = np.frombuffer(text, np.uint8)[begin:]
        most = text.count(b"\n", begin) + text.count(b"\r", begin) + 1
        start, body, end = (np.empty(most, np.int64) for _ in range(3))
        key = np.empty(most, np.uint64)
        count = split_lines(data, start, body, end, key)
        return cls(text, start[:count] + begin, body[:count] + begin, end[:count] + begin, key[:count])

    def __len__(self) -> int:
        return len(self.start)

    def __getitem__(self, rows: Any) -> Lines:
        return Lines(self.text, self.start[rows], self.body[rows], self.end[rows], self.key[rows])

    @cached_property
    def octets(self) -> NDArray[np.uint8]:
        """The text as an array."""
        return np.frombuffer(self.text, np.uint8)

    def where(self, *words: bytes) -> Offsets:
        """The rows whose first word is one of the given."""
        found = self.key == keyword(words[0])
        for word in words[1:]:
            found |= self.key == keyword(word)
        return np.flatnonzero(found)

    def rest(self, row: int) -> bytes:
        """What a line says after its first word, without blanks around it."""
        return self.text[self.body[row] : self.end[row]].strip()


@dataclass(frozen=True, eq=False)
class Numbers:
    """Numbers read from lines.

    ``values`` and ``starts`` have one entry a slot, in line order; ``starts`` is -1 where the line had no number left.
    ``counts`` says how many each line had, wanted or not.
    """

    values: Floats
    starts: Offsets
    counts: Offsets


def read_numbers(source: Source, lines: Lines, slots: int | Offsets, *, body: bool = True) -> Numbers:
    """The numbers that lines hold, correctly rounded.

    Parameters
    ----------
    source
        For the names and places in errors.
    lines
        The lines.
    slots
        How many numbers are wanted of each line, or (k + 1,) offsets; missing ones are 0.
    body
        Whether the numbers follow the line's first word, or begin with it.

    Raises
    ------
    UnreadableFile
        A word that is no number, or a number that is not finite, with its line.
    """
    from pliant.io.text_kernels import parse_numbers

    begin = lines.body if body else lines.start
    offsets = slots * np.arange(len(lines) + 1) if isinstance(slots, int) else slots
    values, starts = np.empty(offsets[-1]), np.empty(offsets[-1], np.int64)
    counts = np.empty(len(lines), np.int64)

    def work(first: int, stop: int) -> None:
        parse_numbers(lines.octets, begin, lines.end, offsets, first, stop, values, starts, counts)

    for_chunks(work, len(lines))
    for at in np.flatnonzero(np.isnan(values)):
        values[at] = _number(source, lines.text, int(starts[at]))
    return Numbers(values, starts, counts)


def count_words(source: Source, lines: Lines, *, body: bool = True) -> Offsets:
    """(k,) how many words each line holds."""
    return read_numbers(source, lines, 0, body=body).counts


def _number(source: Source, text: bytes, at: int) -> float:
    found = _BLANKS.search(text, at)
    word = text[at : found.start() if found else len(text)]
    try:
        value = float(word) if b"_" not in word else None
    except ValueError:
        value = None
    if value is None:
        raise source.unreadable(f"{word[:40]!r} stands where a number should", "correct the line", at=at)
    if not np.isfinite(value):
        raise source.unreadable(f"{word[:40]!r} is not a finite number", "correct or remove it", at=at)
    return value


def number_text(values: NDArray[Any]) -> bytes:
    """Numbers as text, comma-separated: the shortest that reads back as the same number."""
    return orjson.dumps(np.ascontiguousarray(values).reshape(-1), option=orjson.OPT_SERIALIZE_NUMPY)[1:-1]


def rows_text(values: NDArray[Any], prefix: bytes = b"", separator: bytes = b" ") -> bytes:
    """(k, d) numbers as k lines of d, each line with a prefix."""
    if not values.size:
        return (prefix.rstrip() + b"\n") * len(values)
    text = orjson.dumps(np.ascontiguousarray(values), option=orjson.OPT_SERIALIZE_NUMPY)[2:-2]
    text = text.replace(b"],[", b"\n" + prefix)
    return prefix + text.replace(b",", separator) + b"\n"


def ragged_text(rows: Ragged, prefix: bytes = b"", *, counted: bool = False) -> bytes:
    """Rows of different lengths as lines of whole numbers, each line with a prefix, and its count if wanted."""
    if not len(rows.flat) or (rows.lengths == 0).any():
        lines = ([*([len(row)] if counted else []), *row.tolist()] for row in rows)
        return b"".join(prefix + b" ".join(b"%d" % number for number in line) + b"\n" for line in lines)
    if rows.uniform:
        matrix = rows.flat.reshape(len(rows), -1)
        return rows_text(np.insert(matrix, 0, rows.uniform, axis=1) if counted else matrix, prefix)
    first = [np.full(len(rows), -1, np.int64), *([rows.lengths] if counted else [])]
    marked = np.insert(rows.flat.astype(np.int64), np.repeat(rows.offsets[:-1], len(first)), np.stack(first, 1).ravel())
    text = number_text(marked)[len("-1,") :].replace(b",-1,", b"\n" + prefix)
    return prefix + text.replace(b",", b" ") + b"\n"


def patched(data: bytes, starts: Offsets, old: Floats, new: Floats) -> bytes | memoryview:
    """The text with the numbers exchanged that differ; all else byte for byte as it was.

    Parameters
    ----------
    data
        The text.
    starts
        (k,) where the numbers stand.
    old, new
        (k,) the numbers that the text says, and those that it shall say.
    """
    at = np.flatnonzero((old != new) | (np.signbit(old) != np.signbit(new)))
    if not len(at):
        return data
    if (np.diff(starts[at]) < 0).any():
        at = at[np.argsort(starts[at], kind="stable")]
    return spliced(data, starts[at], number_text(new[at]))


def spliced(data: bytes, starts: Offsets, text: bytes) -> memoryview:
    """The words at ascending offsets replaced by the pieces of a comma-separated text."""
    from pliant.io.text_kernels import splice_tokens

    out = np.empty(len(data) + len(text), np.uint8)
    size = splice_tokens(np.frombuffer(data, np.uint8), starts, np.frombuffer(text, np.uint8), out)
    return memoryview(out)[:size]  # type: ignore[arg-type]
