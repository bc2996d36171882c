"""Damage done to files, the same every time: cut, flipped, inserted, deleted, swapped, inflated, spliced."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence

_NUMBERS = (
    b"0",
    b"-1",
    b"1e9",
    b"999999999",
    b"4294967296",
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
    words = data.split(b" ")
    words[rng.randrange(len(words))] = rng.choice(_NUMBERS)
    return b" ".join(words)


def _lines(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    lines = data.split(b"\n")
    at = rng.randrange(len(lines))
    lines[at : at + 1] = [lines[at]] * rng.choice([0, 2, 3])
    return b"\n".join(lines)


def _splice(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    other = rng.choice(others)
    return data[: rng.randrange(len(data) + 1)] + other[rng.randrange(len(other)) :]


MUTATIONS: tuple[Mutation, ...] = (_cut, _flip, _insert, _delete, _swap, _inflate, _lines, _splice)


def mutants(seed: bytes, others: Sequence[bytes], count: int, key: str) -> list[bytes]:
    """So many damaged copies of a file, one to three mutations each; the same for the same key."""
    rng = random.Random(key)
    result = []
    for _ in range(count):
        data = seed
        for _i in range(rng.choice([1, 1, 1, 2, 3])):
            data = rng.choice(MUTATIONS)(data, rng, others)
        result.append(data)
    return result
