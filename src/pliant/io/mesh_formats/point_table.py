"""Tables of points, .xyz and .csv: a point in each row, whose first line may name the columns."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.io.mesh_formats.carrier import carrier_of, with_carrier
from pliant.io.mesh_formats.colors import is_color
from pliant.io.mesh_formats.format import Encoded, Keeps, MeshFormat, Source
from pliant.io.mesh_formats.losses import losses_of
from pliant.io.text import Floats, Lines, Offsets, bytes_of, patched, plain_text, read_numbers, rows_text, text_of
from pliant.mesh import PolygonMesh

_POINT, _NORMAL, _COLOR = ("x", "y", "z"), ("nx", "ny", "nz"), ("red", "green", "blue", "alpha")
_SHORT = {"r": "red", "g": "green", "b": "blue", "a": "alpha"}
_SEPARATORS = bytes.maketrans(b",;", b"  ")
_NUMBER = re.compile(rb"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_HEADER = re.compile(rb"[^\S\r\n]*(?:#|//)?([^\r\n]*)")


@dataclass(frozen=True, eq=False)
class Layout:
    """Where the numbers stand: (n, 3) offsets of positions, and of normals if there are any."""

    points: Offsets
    normals: Offsets | None


class PointTable(MeshFormat):
    """Points, normals, colours and named numbers, separated by blanks, commas or semicolons."""

    name = "point table"
    suffixes = (".xyz", ".csv")
    keeps = Keeps(faces=False, vertex_normals=True, vertex_colors=True, vertex_attributes=True)

    def sniff(self, data: bytes) -> bool:
        """Whether the first line names the columns x, y and z."""
        return set(_POINT) <= {_plain(name) for name in _names(data[:4096])}

    def read(self, source: Source) -> PolygonMesh:
        """The points that a table holds."""
        text = plain_text(source)
        names = _names(text)
        begin = _HEADER.match(text).end() if names else 0  # type: ignore[union-attr]
        lines = Lines.of(text.translate(_SEPARATORS), begin)
        if not len(lines):
            raise source.unreadable("there is no point", "a table needs rows of at least three numbers", at=0)
        columns = len(names) or int(read_numbers(source, lines[:1], 0, body=False).counts[0])
        numbers = read_numbers(source, lines, columns, body=False)
        odd = np.flatnonzero((numbers.counts != columns) | (columns < 3))
        if len(odd):
            cause = f"a row has {numbers.counts[odd[0]]} numbers; {max(columns, 3)} are expected"
            raise source.unreadable(cause, "complete or remove the row", at=int(lines.start[odd[0]]))
        table, starts = numbers.values.reshape(-1, columns), numbers.starts.reshape(-1, columns)
        known = _known([_plain(name) for name in names]) if names else _guessed(table)
        if "points" not in known:
            raise source.unreadable("no columns are named x, y and z", "name them in the first line", at=0)
        used = [column for columns in known.values() for column in columns]
        attributes: dict[str, Any] = {}
        if "normals" in known:
            attributes["normals"] = table[:, known["normals"]]
        if "colors" in known:
            attributes["colors"] = _colors(table[:, known["colors"]])
        for i in set(range(columns)) - set(used):
            attributes[names[i] if names else f"column {i + 1}"] = table[:, i]
        places = {name: starts[:, columns] for name, columns in known.items()}
        mesh = PolygonMesh(table[:, known["points"]], vertex_attributes=attributes)
        return with_carrier(mesh, self.name, source.data, Layout(places["points"], places.get("normals")))

    def encode(self, mesh: PolygonMesh, path: Path) -> Encoded:
        """The file that the mesh was read from, with other numbers; a new one if that was none or another."""
        carrier = carrier_of(mesh, self.name)
        if carrier is None:
            return _new_file(mesh, self.keeps, b"," if path.suffix.lower() == ".csv" else b" ")
        layout: Layout = carrier.layout
        starts, old, new = [layout.points.ravel()], [carrier.mesh.points.ravel()], [mesh.points.ravel()]
        if layout.normals is not None:
            starts.append(layout.normals.ravel())
            old.append(carrier.mesh.vertex_attributes["normals"].ravel())
            new.append(np.asarray(mesh.vertex_attributes["normals"], np.float64).ravel())
        return Encoded([patched(carrier.data, np.concatenate(starts), np.concatenate(old), np.concatenate(new))])


def _names(data: bytes) -> list[str]:
    """The columns' names, if the first line names any; each once."""
    found = _HEADER.match(data.removeprefix(b"\xef\xbb\xbf"))
    line = found[1] if found else b""
    words = [word.strip(b" \t\"'") for word in line.split(b",")] if b"," in line else line.replace(b";", b" ").split()
    names = [text_of(word) for word in words]
    wordy = any(word and _NUMBER.fullmatch(word) is None for word in words)
    return (
        names
        if wordy and len(set(names)) == len(names) and all(names) and set(_POINT) <= set(map(_plain, names))
        else []
    )


def _plain(name: str) -> str:
    lower = name.lower()
    return _SHORT.get(lower, lower)


def _known(names: Sequence[str]) -> dict[str, list[int]]:
    """Which columns are positions, normals and colours, by their names."""
    result = {}
    for kind, wanted in (("points", _POINT), ("normals", _NORMAL), ("colors", _COLOR[:3])):
        if set(wanted) <= set(names):
            result[kind] = [names.index(name) for name in wanted]
    if "colors" in result and "alpha" in names:
        result["colors"].append(names.index("alpha"))
    return result


def _guessed(table: Floats) -> dict[str, list[int]]:
    """Which columns are positions, normals and colours, by what they hold: unit lengths, or bytes."""
    result = {"points": [0, 1, 2]}
    for first in range(3, table.shape[1] - 2, 3):
        columns = [first, first + 1, first + 2]
        part = table[:, columns]
        lengths = np.linalg.norm(np.clip(part, -2, 2), axis=1)  # of huge numbers the squares are not finite
        if "normals" not in result and (np.abs(lengths - 1) < 0.01).all():
            result["normals"] = columns
        elif "colors" not in result and _colors(part).dtype == np.uint8:
            result["colors"] = columns
        else:
            break
    return result


def _colors(values: Floats) -> NDArray[Any]:
    """Whole numbers are bytes; all others stay what they are."""
    whole = (values % 1 == 0).all() and values.min(initial=0) >= 0 and values.max(initial=0) <= 255
    return values.astype(np.uint8) if whole and values.max(initial=0) > 1 else values


def _new_file(mesh: PolygonMesh, keeps: Keeps, separator: bytes) -> Encoded:
    """A table with a first line that names its columns."""
    names: list[str] = [*_POINT]
    columns: list[NDArray[Any]] = [mesh.points]
    losses = list(losses_of(mesh, keeps))
    for name, values in mesh.vertex_attributes.items():
        word = "_".join(name.replace(",", " ").replace(";", " ").split())
        parts: tuple[str, ...] = (word,)
        if name == "normals":
            parts = _NORMAL
        elif name == "colors" and is_color(values):
            parts = _COLOR[: values.shape[1]]
        elif values.ndim > 1:
            parts = tuple(f"{word}_{i}" for i in range(int(np.prod(values.shape[1:]))))
            losses.append(f"the vertex attribute {name!r} is split into {len(parts)} columns")
        if values.dtype.kind not in "biuf" or not np.isfinite(values).all() or not word or set(parts) & set(names):
            losses.append(f"the vertex attribute {name!r}: not finite numbers under a name of their own")
            continue
        names += parts
        typed = values.astype(np.uint8) if values.dtype == bool else values
        columns.append(typed.reshape(len(typed), -1))
    head = bytes_of((separator.decode()).join(names)) + b"\n"
    if len(columns) == 1 and separator == b" ":
        head = b""
    if all(values.dtype == np.float64 for values in columns):
        return Encoded([head, rows_text(np.hstack(columns), separator=separator)], tuple(losses))
    texts = [rows_text(values, separator=separator).splitlines() for values in columns]
    return Encoded([head, *(separator.join(row) + b"\n" for row in zip(*texts, strict=True))], tuple(losses))
