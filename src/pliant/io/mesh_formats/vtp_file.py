"""The plain case of an XML polydata file, read here: one piece, binary arrays, zlib or no compression.

VTK in a process of its own reads the rest, and whatever is damaged: this reader then gives None. Layout of the
blocks: VTK file formats, "XML file formats", and its compressed header [blocks, size, last size, sizes].
"""

from __future__ import annotations

import binascii
import zlib
from typing import Any
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

Arrays = dict[str, NDArray[Any]]

_TYPES = {
    f"{kind}Int{8 * size}": f"{letter}{size}" for kind, letter in (("", "i"), ("U", "u")) for size in (1, 2, 4, 8)
}
_TYPES |= {"Float32": "f4", "Float64": "f8"}
_ACTIVE = ("Scalars", "Vectors", "Normals", "TCoords")
_COUNTS = {"Verts": "NumberOfVerts", "Lines": "NumberOfLines", "Polys": "NumberOfPolys", "Strips": "NumberOfStrips"}
_GROWTH, _ROOM = 64, 1 << 26  # how much compressed bytes may grow before VTK shall judge them, within its limits


class _Other(Exception):
    """The file is not the plain case."""


def read(data: bytes) -> tuple[Arrays, dict[str, Any]] | None:
    """What :func:`pliant.io.mesh_formats.polydata_process.read` gives, or None where VTK must read the file."""
    try:
        return _File(data).arrays()
    except (_Other, expat.ExpatError, binascii.Error, zlib.error, LookupError, OverflowError, ValueError):
        return None


class _File:
    """The elements of the file, and where the bytes of its arrays are."""

    def __init__(self, data: bytes) -> None:
        start = data.find(b"<AppendedData")
        head = data if start < 0 else data[:start] + b"</VTKFile>"
        self.sections: dict[str, list[dict[str, str]]] = {}
        self.attributes: dict[str, dict[str, str]] = {}
        self._inside: list[str] = []
        self._text: list[str] = []
        parser = expat.ParserCreate()
        parser.buffer_text = True
        parser.StartDoctypeDeclHandler = self._refuse
        parser.StartElementHandler = self._begin
        parser.EndElementHandler = self._end
        parser.CharacterDataHandler = self._characters
        parser.Parse(head, True)
        root = self.attributes["VTKFile"]
        if root.get("compressor") not in (None, "", "vtkZLibDataCompressor"):
            raise _Other
        self._order = {"LittleEndian": "<", "BigEndian": ">"}[root["byte_order"]]
        self._size = np.dtype(self._order + _TYPES[root.get("header_type", "UInt32")])
        self._compressed = bool(root.get("compressor"))
        self._raw = b'encoding="raw"' in data[start : start + 200] if start >= 0 else False
        self._appended = memoryview(data)[data.index(b"_", start) + 1 :] if start >= 0 else memoryview(b"")

    def arrays(self) -> tuple[Arrays, dict[str, Any]]:
        """The arrays and their names."""
        piece = {name: int(number) for name, number in self.attributes["Piece"].items() if name.startswith("Number")}
        count = piece["NumberOfPoints"]
        arrays: Arrays = {"points": np.empty((0, 3))}
        for element in self.sections.get("Points", []):
            arrays["points"] = self._array(element, count).reshape(count, 3)
        for section, key in _COUNTS.items():
            rows = piece.get(key, 0)
            parts = {element["Name"]: element for element in self.sections.get(section, [])} if rows else {}
            ends = self._array(parts["offsets"], rows).astype(np.int64) if rows else np.empty(0, np.int64)
            arrays[f"{section.lower()}.offsets"] = np.concatenate([[0], ends])
            flat = self._array(parts["connectivity"], int(ends[-1])) if rows else ends
            arrays[f"{section.lower()}.flat"] = flat.astype(np.int64, copy=False)
        meta: dict[str, Any] = {"skipped": [], "names": {}, "active": {}}
        cells = sum(piece.get(key, 0) for key in _COUNTS.values())
        self._fields("point", "PointData", count, arrays, meta)
        self._fields("cell", "CellData", cells, arrays, meta)
        self._fields("field", "FieldData", None, arrays, meta)
        return arrays, meta

    def _fields(self, kind: str, section: str, rows: int | None, arrays: Arrays, meta: dict[str, Any]) -> None:
        names: list[str] = []
        meta["names"][kind] = names
        for element in self.sections.get(section, []):
            if element["type"] == "String":
                meta["skipped"].append(element["Name"])
                continue
            count = int(element["NumberOfTuples"]) if rows is None else rows
            arrays[f"{kind}.{len(names)}"] = self._array(element, count)
            names.append(element["Name"])
        if rows is not None:
            given = self.attributes.get(section, {})
            meta["active"][kind] = {word: given[word] for word in _ACTIVE if given.get(word) in names}

    def _array(self, element: dict[str, str], rows: int) -> NDArray[Any]:
        """(rows,) or (rows, components) the numbers of one array."""
        kind = np.dtype(self._order + _TYPES[element["type"]])
        width = int(element.get("NumberOfComponents") or 1)
        if element["format"] == "appended":
            stream, raw = self._appended[int(element["offset"]) :], self._raw
        elif element["format"] == "binary":
            stream, raw = memoryview(element["text"].strip().encode("ascii")), False
        else:
            raise _Other
        values = np.frombuffer(self._bytes(stream, raw, rows * width * kind.itemsize), kind)
        if len(values) != rows * width:
            raise _Other
        values = values.astype(kind.newbyteorder("="), copy=False)
        return values if width == 1 else values.reshape(rows, width)

    def _bytes(self, stream: memoryview, raw: bool, size: int) -> bytes | memoryview:
        """The bytes of an array, of which there must be ``size``."""
        step = self._size.itemsize
        take = _plain if raw else _base64
        if not self._compressed:
            body = take(stream, 0, step + size)
            if int(np.frombuffer(body[:step], self._size)[0]) != size:
                raise _Other
            return body[step:]
        blocks = int(np.frombuffer(take(stream, 0, step), self._size)[0])
        if not size and not blocks:
            return b""
        head = np.frombuffer(take(stream, 0, (3 + blocks) * step), self._size).astype(np.int64)
        block, last, packed = int(head[1]), int(head[2]), head[3:]
        total = int(packed.sum())
        if (blocks - 1) * block + (last or block) != size or (packed < 0).any() or size > _GROWTH * total + _ROOM:
            raise _Other
        begin = (3 + blocks) * step
        body = take(stream, begin if raw else -(-begin // 3) * 4, total)
        ends = np.cumsum(packed)
        parts = [zlib.decompressobj().decompress(body[e - n : e], block) for e, n in zip(ends, packed, strict=True)]
        return b"".join(parts)

    def _begin(self, name: str, attributes: dict[str, str]) -> None:
        if name in ("DataArray", "Array"):
            self.sections.setdefault(self._inside[-1], []).append(attributes)
            self._text.clear()
        elif name == "Piece" and name in self.attributes:
            raise _Other
        else:
            self.attributes[name] = attributes
        self._inside.append(name)

    def _characters(self, text: str) -> None:
        if self._inside[-1] == "DataArray":
            self._text.append(text)

    def _end(self, name: str) -> None:
        self._inside.pop()
        if name == "DataArray":
            self.sections[self._inside[-1]][-1]["text"] = "".join(self._text)

    def _refuse(self, *_declaration: object) -> None:
        raise _Other


def _plain(stream: memoryview, start: int, size: int) -> memoryview:
    part = stream[start : start + size]
    if len(part) != size:
        raise _Other
    return part


def _base64(stream: memoryview, start: int, size: int) -> memoryview:
    part = binascii.a2b_base64(stream[start : start + -(-size // 3) * 4])
    if len(part) < size:
        raise _Other
    return memoryview(part)[:size]
