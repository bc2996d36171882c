"""Frames: what travels between the studio and its pages, both ways.

A frame is a u32 length, that many bytes of JSON, and arrays, each at a multiple of eight bytes so that the page can
use them where they lie. The JSON lists the arrays: their names, types and lengths.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import orjson
from numpy.typing import NDArray

from pliant.errors import PliantError

Arrays = Mapping[str, NDArray[Any]]

TYPES = {"f4": "<f4", "f8": "<f8", "u4": "<u4", "i4": "<i4", "u2": "<u2", "i1": "|i1", "u1": "|u1"}
_OPTIONS = orjson.OPT_SERIALIZE_NUMPY | orjson.OPT_NON_STR_KEYS
_ALIGNMENT = 8


class MalformedFrame(PliantError):
    """Bytes that are no frame."""


@dataclass(frozen=True)
class Frame:
    """A message.

    Parameters
    ----------
    head
        What JSON holds.
    arrays
        Numbers beside it, by name; they travel flat.
    """

    head: Mapping[str, Any] = field(default_factory=dict)
    arrays: Arrays = field(default_factory=dict)

    def encode(self) -> bytes:
        """The frame as bytes."""
        pieces = {name: np.ascontiguousarray(array) for name, array in self.arrays.items()}
        listed = [{"name": name, "type": _code(array), "length": array.size} for name, array in pieces.items()]
        json = orjson.dumps({**self.head, "arrays": listed}, option=_OPTIONS)
        parts: list[bytes | memoryview] = [len(json).to_bytes(4, "little"), json, _padding(4 + len(json))]
        for array in pieces.values():
            parts += [array.reshape(-1).view(np.uint8).data, _padding(array.nbytes)]
        return b"".join(parts)

    @classmethod
    def decode(cls, data: bytes) -> Frame:
        """The frame that bytes are.

        Raises
        ------
        MalformedFrame
            They are none: too short, no JSON, arrays that are not there or of no known type.
        """
        if len(data) < 4:
            raise MalformedFrame(f"a frame of {len(data)} bytes; four are its length")
        end = 4 + int.from_bytes(data[:4], "little")
        if end > len(data):
            raise MalformedFrame(f"a frame says that its head ends at byte {end}; it has {len(data)}")
        try:
            head = orjson.loads(data[4:end])
        except orjson.JSONDecodeError as error:
            raise MalformedFrame(f"the head of a frame is no JSON: {error}") from error
        if not isinstance(head, dict):
            raise MalformedFrame("the head of a frame is no object")
        listed = head.pop("arrays", [])
        if not isinstance(listed, list):
            raise MalformedFrame("the arrays of a frame are no list")
        return cls(head, _arrays(data, _aligned(end), listed))


def _arrays(data: bytes, at: int, listed: list[Any]) -> dict[str, NDArray[Any]]:
    found: dict[str, NDArray[Any]] = {}
    for entry in listed:
        try:
            name, kind, length = str(entry["name"]), np.dtype(TYPES[entry["type"]]), int(entry["length"])
        except (TypeError, KeyError, ValueError) as error:
            raise MalformedFrame(f"an array of a frame is described by {str(entry)[:80]}") from error
        if length < 0 or at + length * kind.itemsize > len(data):
            raise MalformedFrame(f"array {name!r} of {length} numbers ends behind its frame")
        array = np.frombuffer(data, kind, length, at)
        if kind.kind == "f" and not np.isfinite(array).all():
            raise MalformedFrame(f"array {name!r} holds numbers that are not finite")
        found[name] = array
        at = _aligned(at + array.nbytes)
    return found


def _code(array: NDArray[Any]) -> str:
    return array.dtype.str[1:]


def _aligned(at: int) -> int:
    return -(-at // _ALIGNMENT) * _ALIGNMENT


def _padding(size: int) -> bytes:
    return bytes(_aligned(size) - size)
