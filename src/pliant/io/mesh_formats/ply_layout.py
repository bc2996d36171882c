"""The header of a PLY file: elements, their properties, and how the body stores them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

import numpy as np

from pliant.io.mesh_formats.format import Source
from pliant.io.text import text_of

_WORDS = {
    "i1": ("char", "int8"),
    "u1": ("uchar", "uint8"),
    "i2": ("short", "int16"),
    "u2": ("ushort", "uint16"),
    "i4": ("int", "int32"),
    "u4": ("uint", "uint32"),
    "f4": ("float", "float32"),
    "f8": ("double", "float64"),
}
TYPES = {word: kind for kind, words in _WORDS.items() for word in words}
NAMES = {kind: words[0] for kind, words in _WORDS.items()}
_END = re.compile(rb"(?:^|[\r\n])end_header[ \t]*(\r\n|\n|\r)")
_ENCODINGS: dict[str, Literal["", "<", ">"]] = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass(frozen=True)
class Property:
    """A property: its type, and the type of its count where it is a list."""

    name: str
    type: str
    count: str | None = None


@dataclass(frozen=True)
class Element:
    """An element: how many there are and what each says."""

    name: str
    count: int
    properties: tuple[Property, ...]

    def least(self, *, text: bool) -> int:
        """The bytes that one of them takes at least."""
        if text:
            return 2 * len(self.properties)
        return sum(np.dtype(each.count or each.type).itemsize for each in self.properties)


@dataclass(frozen=True)
class Header:
    """What a PLY file says of itself; ``order`` is ``<`` or ``>``, or empty for text."""

    order: Literal["", "<", ">"]
    elements: tuple[Element, ...]
    size: int


def parse(source: Source) -> Header:
    """The header, checked against the size of the file.

    Raises
    ------
    UnreadableFile
        A line that cannot be understood, or more elements than the file could hold.
    """
    end = _END.search(source.data, 0, 1 << 24)
    if end is None:
        raise source.unreadable(
            "the header does not end", "the file is cut off before 'end_header': copy it again", at=0
        )
    order: Literal["", "<", ">"] | None = None
    elements: list[Element] = []
    head, at = source.data[: end.start()], 0
    for raw in re.split(rb"\r\n|\n|\r", head)[1:]:
        at = head.index(raw, at) if raw else at
        words = text_of(raw).split()
        try:
            if words and words[0] == "format":
                order = _ENCODINGS[words[1]]
            elif words and words[0] == "element":
                elements.append(Element(words[1], _count(words[2]), ()))
            elif words and words[0] == "property":
                last = elements[-1]
                elements[-1] = Element(last.name, last.count, (*last.properties, _property(words[1:])))
            elif words and words[0] not in ("comment", "obj_info"):
                raise KeyError(words[0])
        except (KeyError, IndexError, ValueError) as error:
            line = raw[:60].decode("utf-8", "replace")
            raise source.unreadable(f"the header line {line!r} is not PLY", "correct it", at=at) from error
    if order is None:
        raise source.unreadable("the header names no format", "add 'format ascii 1.0' or another", at=0)
    header = Header(order, tuple(elements), end.end())
    _require_room(source, header)
    return header


def _count(word: str) -> int:
    if not (word.isascii() and word.isdigit() and len(word) < 16):
        raise ValueError(word)
    return int(word)


def _property(words: list[str]) -> Property:
    if words[0] == "list":
        count = TYPES[words[1]]
        if count.startswith("f"):
            raise ValueError(words[1])
        return Property(words[3], TYPES[words[2]], count)
    return Property(words[1], TYPES[words[0]])


def _require_room(source: Source, header: Header) -> None:
    room = len(source.data) - header.size + 1
    for element in header.elements:
        needed = element.count * element.least(text=not header.order)
        if needed > room or element.count > room:
            cause = f"{element.count:,} of {element.name!r} are announced; {room - 1:,} bytes are left for them"
            raise source.unreadable(
                cause, "the file is cut off, or the count is wrong: copy it again", at=header.size, text=False
            )
        room -= needed
