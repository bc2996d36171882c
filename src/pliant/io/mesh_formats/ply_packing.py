"""Columns of values packed into the rows of a PLY element."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.io.mesh_formats.ply_layout import NAMES
from pliant.numerics.compute.chunks import for_chunks


@dataclass(frozen=True, eq=False)
class Block:
    """Properties of one type side by side: (n, d) values."""

    names: tuple[str, ...]
    values: NDArray[Any]

    def header(self) -> str:
        """The lines that declare it."""
        return "".join(f"property {NAMES[self.values.dtype.str[1:]]} {name}\n" for name in self.names)


@dataclass(frozen=True, eq=False)
class Lists:
    """A property whose rows are lists, one after another."""

    name: str
    values: NDArray[Any]
    offsets: NDArray[np.int64]

    @cached_property
    def lengths(self) -> NDArray[np.int64]:
        """How long each list is."""
        return np.diff(self.offsets)

    @cached_property
    def count(self) -> np.dtype[Any]:
        """The type that lengths are stored in."""
        return np.dtype("u1" if self.lengths.max(initial=0) < 256 else "<i4")

    def header(self) -> str:
        """The line that declares it."""
        return f"property list {NAMES[self.count.str[1:]]} {NAMES[self.values.dtype.str[1:]]} {self.name}\n"


def packed(columns: list[Block | Lists], rows: int) -> memoryview:
    """The rows of all columns, interleaved."""
    lists = [column for column in columns if isinstance(column, Lists)]
    if rows and all((column.lengths == column.lengths[0]).all() for column in lists):
        return _packed_alike(columns, rows)
    pieces = []  # (values, how many a row) of each count, list and block
    for column in columns:
        if isinstance(column, Lists):
            pieces.append((column.lengths.astype(column.count), np.ones(rows, np.int64)))
            pieces.append((_little(column.values), column.lengths))
        else:
            pieces.append((_little(column.values).ravel(), np.full(rows, column.values.shape[1])))
    sizes = [length * values.itemsize for values, length in pieces]
    ends = np.cumsum(np.sum(sizes, axis=0))
    body = np.empty(int(ends[-1]) if rows else 0, np.uint8)
    place = ends - np.sum(sizes, axis=0)
    for (values, length), size in zip(pieces, sizes, strict=True):
        width = values.itemsize
        at = np.repeat(place - width * (np.cumsum(length) - length), length) + width * np.arange(len(values))
        body[at[:, None] + np.arange(width)] = np.ascontiguousarray(values).view(np.uint8).reshape(-1, width)
        place = place + size
    return body.data


def _packed_alike(columns: list[Block | Lists], rows: int) -> memoryview:
    """The rows of columns whose lists are all of one length."""
    fields: list[tuple[str, Any, tuple[int, ...]]] = []
    for i, column in enumerate(columns):
        width = column.values.shape[1] if isinstance(column, Block) else int(column.lengths[0])
        if isinstance(column, Lists):
            fields.append((f"count{i}", column.count, ()))
        fields.append((f"values{i}", column.values.dtype.newbyteorder("<"), (width,)))
    first = columns[0].values
    if len(fields) == 1 and first.dtype == fields[0][1] and first.flags.c_contiguous:
        return first.reshape(-1).view(np.uint8).data
    record = np.empty(rows, np.dtype(fields))

    def work(start: int, stop: int) -> None:
        for i, column in enumerate(columns):
            if isinstance(column, Lists):
                record[f"count{i}"][start:stop] = column.lengths[0]
            record[f"values{i}"][start:stop] = column.values.reshape(rows, -1)[start:stop]

    for_chunks(work, rows)
    return record.view(np.uint8).data


def _little(values: NDArray[Any]) -> NDArray[Any]:
    return np.asarray(values, values.dtype.newbyteorder("<"))
