"""Where the nodes' coordinates stand in a gmsh file of version 2.2 or 4.1, so that they alone can be exchanged."""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnreadableFile
from pliant.io.mesh_formats.format import Source
from pliant.io.text import Floats, Lines, Offsets, count_words, patched, read_numbers

FORMAT = re.compile(rb"\s*\$MeshFormat\s+([\d.]+)\s+([01])\s+(\d+)[ \t]*\r?\n")
_NODES = re.compile(rb"(?m)^\$Nodes[ \t]*\r?\n")
_END = re.compile(rb"\n\$EndNodes")


@dataclass(frozen=True, eq=False)
class Nodes:
    """(n, 3) byte offsets of coordinates: of words, or of little-endian float64."""

    starts: Offsets
    text: bool

    def exchanged(self, data: bytes, old: Floats, new: Floats) -> bytes | memoryview:
        """The file with the coordinates exchanged that differ."""
        if self.text:
            return patched(data, self.starts.ravel(), old.ravel(), new.ravel())
        octets = np.frombuffer(data, np.uint8).copy()
        octets[self.starts.ravel()[:, None] + np.arange(8)] = new.astype("<f8").reshape(-1, 1).view(np.uint8)
        return octets.data


def located(source: Source, points: Floats) -> Nodes | None:
    """Where the given points stand; None in a version that is not known, or where others stand there."""
    head = FORMAT.match(source.data)
    begin = _NODES.search(source.data)
    if head is None or begin is None or head[1] not in (b"2.2", b"4.1"):
        return None
    text = head[2] == b"0"
    try:
        starts = (_words if text else _octets)(source, begin.end(), head[1] == b"4.1")
    except (UnreadableFile, struct.error, ValueError, IndexError):
        return None
    if starts.shape != points.shape or (starts < 0).any() or (starts > len(source.data) - (1 if text else 8)).any():
        return None
    nodes = Nodes(starts, text)
    return nodes if np.array_equal(_values(source, nodes), points) else None


def _values(source: Source, nodes: Nodes) -> Floats:
    """The coordinates that stand there."""
    if nodes.text:
        first = nodes.starts.ravel()
        words = [source.data[at : at + 32].split(maxsplit=1)[0] for at in first.tolist()]
        return np.array(words, np.float64).reshape(-1, 3)
    octets = np.frombuffer(source.data, np.uint8)
    stored = octets[nodes.starts.ravel()[:, None] + np.arange(8)]
    return np.ascontiguousarray(stored).view("<f8").reshape(-1, 3).astype(np.float64)


def _words(source: Source, begin: int, blocks: bool) -> Offsets:
    end = _END.search(source.data, begin)
    lines = Lines.of(source.data[: end.start() if end else len(source.data)], begin)
    counts = count_words(source, lines, body=False)
    numbers = read_numbers(source, lines, 4, body=False)
    starts, values = numbers.starts.reshape(-1, 4), numbers.values.reshape(-1, 4)
    if not blocks:
        return starts[1:, 1:]
    rows: list[NDArray[np.int64]] = []
    at = 1
    while at < len(lines) and counts[at] == 4:
        count = int(values[at, 3])
        rows.append(np.arange(at + 1 + count, at + 1 + 2 * count))
        at += 1 + 2 * count
    return starts[np.concatenate(rows), :3]


def _octets(source: Source, begin: int, blocks: bool) -> Offsets:
    data, step = source.data, 8 * np.arange(3)
    if not blocks:
        end = data.index(b"\n", begin)
        return end + 5 + 28 * np.arange(int(data[begin:end]))[:, None] + step
    count = struct.unpack_from("<Q", data, begin)[0]
    at, rows = begin + 32, [np.empty((0, 3), np.int64)]
    for _ in range(min(count, len(data))):
        parametric, size = struct.unpack_from("<iQ", data, at + 8)
        if parametric or size > len(data):
            raise ValueError("coordinates of parametric nodes")
        at += 20 + 8 * size
        rows.append(at + 24 * np.arange(size)[:, None] + step)
        at += 24 * size
    return np.concatenate(rows)
