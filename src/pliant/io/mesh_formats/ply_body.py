"""The body of a PLY file: columns of numbers, and ragged columns of lists.

Text bodies become binary ones in which every number is a float64, so that one decoder serves all.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.io.mesh_formats.format import Source
from pliant.io.mesh_formats.ply_layout import Element, Header, Property
from pliant.io.text import Lines, Offsets, count_words, plain_text, read_numbers


@dataclass(frozen=True, eq=False)
class Column:
    """A property's values: one an element, or, where ``offsets`` is given, ragged rows of a list.

    ``at`` says at which byte of the file the value of each element begins, or its list's count.
    """

    values: NDArray[Any]
    at: Offsets | range
    offsets: Offsets | None = None


def decode(source: Source, header: Header) -> dict[str, dict[str, Column]]:
    """All properties of all elements, by name.

    Raises
    ------
    UnreadableFile
        The body is cut off, goes on behind its last element, or holds a word that is no number.
    """
    data, at, starts = np.frombuffer(source.data, np.uint8), header.size, None
    if not header.order:
        lines = Lines.of(plain_text(source), header.size)
        counts = count_words(source, lines, body=False)
        numbers = read_numbers(source, lines, np.concatenate([[0], np.cumsum(counts)]), body=False)
        data, at, starts = numbers.values.view(np.uint8), 0, numbers.starts
    result = {}
    for element in header.elements:
        columns, end = _element(source, data, at, element, header.order)
        if starts is not None:
            columns = {name: _in_text(column, starts) for name, column in columns.items()}
        result[element.name] = columns
        at = end
    return result


def _in_text(column: Column, starts: Offsets) -> Column:
    """Byte offsets of the substitute as offsets in the text."""
    at = column.at
    places = starts[at.start // 8 : at.stop // 8 : at.step // 8] if isinstance(at, range) else starts[at // 8]
    return Column(column.values, places, column.offsets)


def _element(
    source: Source, data: NDArray[np.uint8], at: int, element: Element, order: str
) -> tuple[dict[str, Column], int]:
    from pliant.io.mesh_formats.ply_walk import walk_lists

    types = [_type(each.type, order) for each in element.properties]
    counts = [None if each.count is None else _type(each.count, order) for each in element.properties]
    rows = element.count
    fixed = _fixed(data, at, rows, element.properties, types, counts)
    if fixed is not None:
        return fixed
    if all(each.count is None for each in element.properties):
        raise _cut(source, element, (len(data) - at) // sum(each.itemsize for each in types), order)
    places, lengths = np.empty((rows, len(types)), np.int64), np.empty((rows, len(types)), np.int64)
    widths = [each.itemsize if each else 0 for each in counts]
    end = walk_lists(
        data,
        at,
        rows,
        np.array([each.itemsize for each in types]),
        np.array(widths),
        np.array([2 if not order else int(each is not None and each.kind == "i") for each in counts]),
        order != ">",
        places,
        lengths,
    )
    if end < 0:
        raise _cut(source, element, -1 - end, order)
    columns = {}
    for i, each in enumerate(element.properties):
        offsets = np.concatenate([[0], np.cumsum(lengths[:, i])])
        width = types[i].itemsize
        first = places[:, i] + widths[i]
        items = np.repeat(first - width * offsets[:-1], lengths[:, i]) + width * np.arange(offsets[-1])
        values = data[items[:, None] + np.arange(width)].reshape(-1).view(types[i])
        columns[each.name] = Column(_native(values), places[:, i], offsets if each.count else None)
    return columns, int(end)


def _fixed(
    data: NDArray[np.uint8],
    at: int,
    rows: int,
    properties: tuple[Property, ...],
    types: list[np.dtype[Any]],
    counts: list[np.dtype[Any] | None],
) -> tuple[dict[str, Column], int] | None:
    """The properties where every list is as long as the first element's; None where they are not."""
    fields: list[tuple[str, Any]] = []
    place = at
    lengths: list[int] = []
    for i, (kind, count) in enumerate(zip(types, counts, strict=True)):
        length = 1
        if count is not None:
            if not rows or place + count.itemsize > len(data):
                return None
            number = data[place : place + count.itemsize].view(count)[0]
            if not 0 <= number < len(data) or number % 1:
                return None
            length = int(number)
            fields.append((f"count{i}", count))
            place += count.itemsize
            fields.append((f"value{i}", (kind, (length,))))
        else:
            fields.append((f"value{i}", kind))
        lengths.append(length)
        place += length * kind.itemsize
    record = np.dtype(fields)
    end = at + rows * record.itemsize
    if end > len(data):
        return None
    table = data[at:end].view(record) if record.itemsize else np.empty(rows, record)
    columns = {}
    for i, each in enumerate(properties):
        if counts[i] is not None and not (table[f"count{i}"] == lengths[i]).all():
            return None
        first = record.fields[f"count{i}" if counts[i] is not None else f"value{i}"][1]  # type: ignore[index]
        begins = range(at + first, at + first + record.itemsize * rows, max(record.itemsize, 1))
        offsets = None if counts[i] is None else lengths[i] * np.arange(rows + 1)
        columns[each.name] = Column(_native(table[f"value{i}"].reshape(-1)), begins, offsets)
    return columns, end


def _type(kind: str, order: str) -> np.dtype[Any]:
    return np.dtype(order + kind if order else "f8")


def _native(values: NDArray[Any]) -> NDArray[Any]:
    return np.ascontiguousarray(values, values.dtype.newbyteorder("="))


def _cut(source: Source, element: Element, row: int, order: str) -> Exception:
    cause = (
        f"{element.count:,} of {element.name!r} are announced; the file ends, or its lists go wrong, at number {row:,}"
    )
    return source.unreadable(
        cause, "the file is cut off or damaged: copy or export it again", at=len(source.data), text=not order
    )
