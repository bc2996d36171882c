"""Damage done to bytes, the same every time: cut, flipped, inserted, deleted, swapped, inflated, doubled, spliced."""

from __future__ import annotations

import random
import re
import struct
from collections.abc import Callable, Iterator, Sequence

_NUMBERS = (
    b"0",
    b"-1",
    b"1e9",
    b"999999999",
    b"4294967296",
    b"1e308",
    b"1e400",
    b"nan",
    b"-inf",
    b"1_0",
    b"0x10",
    b"1,5",
    b"\xff",
    b"-0.0",
    b"1e-400",
)
_BYTES = (b"\0", b"\xff\xff\xff\xff", b"\n", b"\r", b"#", b"\\\n", b"/", b" ", b"\xef\xbb\xbf", b"\x80" * 9)
_NUMBER = re.compile(rb"[-+]?\d[\d.]*(?:[eE][-+]?\d+)?")
_WHOLE = (0, 1, 0x7F, 0x7FFF, 0x10000, 0x7FFFFFFF, 0x7FFFFFFFFFFFFFFF)
_REAL = (0.0, 1e300, -1e-300, float("nan"), float("inf"))

Mutation = Callable[[bytes, random.Random, Sequence[bytes]], bytes]


def _cut(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    return data[: rng.randrange(len(data) + 1)]


def _flip(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    result = bytearray(data)
    for _i in range(rng.randint(1, 4)):
        if result:
            result[rng.randrange(len(result))] ^= 1 << rng.randrange(8)
    return bytes(result)


def _insert(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    at = rng.randrange(len(data) + 1)
    return data[:at] + rng.choice(_BYTES) + data[at:]


def _delete(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    at = rng.randrange(len(data) + 1)
    return data[:at] + data[at + rng.randint(1, 30) :]


def _swap(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    words = data.split(b" ")
    a, b = rng.randrange(len(words)), rng.randrange(len(words))
    words[a], words[b] = words[b], words[a]
    return b" ".join(words)


def _inflate(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    numbers = list(_NUMBER.finditer(data))
    if not numbers:
        return _insert(data, rng, ())
    at = rng.choice(numbers)
    return data[: at.start()] + rng.choice(_NUMBERS) + data[at.end() :]


def _lines(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    lines = data.split(b"\n")
    at = rng.randrange(len(lines))
    lines[at : at + 1] = [lines[at]] * rng.choice([0, 2, 3])
    return b"\n".join(lines)


def _overwrite(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    """Another binary number in the place of some bytes."""
    order = rng.choice("<>")
    if rng.random() < 0.3:
        number = struct.pack(order + "d", rng.choice(_REAL))
    else:
        size = rng.choice([1, 2, 4, 8])
        value = (rng.choice(_WHOLE) * rng.choice([1, -1])) % (1 << 8 * size)
        number = value.to_bytes(size, "little" if order == "<" else "big")
    at = rng.randrange(max(1, len(data) - len(number) + 1))
    return data[:at] + number + data[at + len(number) :]


def _splice(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    other = rng.choice(others or [data])
    return data[: rng.randrange(len(data) + 1)] + other[rng.randrange(len(other) + 1) :]


MUTATIONS: tuple[Mutation, ...] = (
    _cut,
    _flip,
    _insert,
    _delete,
    _swap,
    _inflate,
    _inflate,
    _lines,
    _overwrite,
    _splice,
)


def damaged(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """A copy with one to three mutations."""
    for _ in range(rng.choice([1, 1, 1, 2, 3])):
        data = rng.choice(MUTATIONS)(data, rng, others)
    return data


def mutant(seed: bytes, others: Sequence[bytes], key: str) -> bytes:
    """A damaged copy of a file, or of what is packed inside it; the same for the same key."""
    from reliability.packings import damaged_inside

    rng = random.Random(key)
    inside = damaged_inside(seed, rng, others) if rng.random() < 0.6 else None
    return damaged(seed, rng, others) if inside is None else inside


def mutants(seed: bytes, others: Sequence[bytes], count: int, key: str, start: int = 0) -> Iterator[bytes]:
    """So many damaged copies of a file; the same for the same key, however many are asked for."""
    for number in range(start, start + count):
        yield mutant(seed, others, f"{key}/{number}")
