"""The container of glTF 2.0: a description in JSON, and buffers inside, beside it, or in a GLB's second chunk."""

from __future__ import annotations

import base64
import binascii
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
import orjson
from numpy.typing import NDArray

from pliant.errors import UnsupportedFormat
from pliant.io.mesh_formats import mtl
from pliant.io.mesh_formats.format import Source

_MAGIC, _JSON, _BIN = b"glTF", 0x4E4F534A, 0x004E4942
_TYPES = {5120: "i1", 5121: "u1", 5122: "i2", 5123: "u2", 5125: "u4", 5126: "f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_HARMLESS = ("KHR_materials_", "KHR_texture_", "KHR_lights_", "KHR_mesh_quantization", "EXT_texture_")


@dataclass(frozen=True, eq=False)
class Place:
    """Where an accessor's values stand: the buffer, and how an (n, d) view of its bytes is laid out."""

    buffer: int
    dtype: np.dtype[Any]
    shape: tuple[int, int]
    offset: int
    strides: tuple[int, int]
    normalized: bool

    def view(self, data: bytes | bytearray) -> NDArray[Any]:
        """The values as they are stored."""
        return np.ndarray(self.shape, self.dtype, data, self.offset, self.strides)


@dataclass(frozen=True, eq=False)
class GltfFile:
    """A description and its buffers; ``binary`` tells a GLB."""

    source: Source
    json: dict[str, Any]
    buffers: tuple[bytes, ...]
    binary: bool

    def place(self, accessor: int) -> Place:
        """Where the values of an accessor stand.

        Raises
        ------
        UnreadableFile
            They reach beyond their buffer.
        """
        said = item(self.json["accessors"], accessor)
        view = item(self.json["bufferViews"], said["bufferView"])
        kind, width, count = np.dtype("<" + _TYPES[said["componentType"]]), _WIDTHS[said["type"]], said["count"]
        offset = view.get("byteOffset", 0) + said.get("byteOffset", 0)
        stride = view.get("byteStride") or kind.itemsize * width
        numbers = (view["buffer"], count, offset, stride, view["byteLength"])
        if not all(isinstance(number, int) and number >= 0 for number in numbers):
            raise self.source.unreadable(f"accessor {accessor} has sizes that are none", "export the file again")
        room = min(len(item(self.buffers, view["buffer"])), view.get("byteOffset", 0) + view["byteLength"])
        if count and offset + stride * (count - 1) + kind.itemsize * width > room:
            cause = f"accessor {accessor} needs {count:,} values; its buffer ends at byte {room:,}"
            raise self.source.unreadable(cause, "the file is cut off: copy or export it again")
        return Place(
            view["buffer"], kind, (count, width), offset, (stride, kind.itemsize), bool(said.get("normalized", False))
        )

    def values(self, accessor: int) -> NDArray[Any]:
        """(n, d) the values of an accessor, as fractions where integers stand for them."""
        place = self.place(accessor)
        if "sparse" in item(self.json["accessors"], accessor):
            raise UnsupportedFormat(f"{self.source.name}: a sparse accessor; export the file without sparse data")
        stored = place.view(self.buffers[place.buffer])
        if place.normalized and place.dtype.kind in "iu":
            return np.maximum(stored / float(np.iinfo(place.dtype).max), -1.0)
        return stored


def item(values: Any, index: Any) -> Any:
    """An entry of a list by an index that the file gives: none is counted from the end."""
    if not isinstance(index, int) or isinstance(index, bool) or index < 0:
        raise IndexError(f"{index!r} is no index")
    return values[index]


def opened(source: Source) -> GltfFile:
    """The description and its buffers.

    Raises
    ------
    UnreadableFile
        A damaged container or description, or a buffer that is not there.
    UnsupportedFormat
        Compression, or another extension that changes what the file means.
    """
    text, chunk = _chunks(source) if source.data.startswith(_MAGIC) else (source.data, b"")
    try:
        json = orjson.loads(text.removeprefix(b"\xef\xbb\xbf"))
    except orjson.JSONDecodeError as error:
        raise source.unreadable(f"the description is no JSON: {error}", "export the file again") from error
    if not isinstance(json, dict) or not isinstance(json.get("asset"), dict):
        raise source.unreadable("the description names no glTF asset", "check what the file is")
    if not str(json["asset"].get("version", "")).startswith("2"):
        raise UnsupportedFormat(f"{source.name}: glTF {json['asset'].get('version')}; export it as glTF 2.0")
    for name in json.get("extensionsRequired", []):
        if "draco" in name or "meshopt" in name:
            raise UnsupportedFormat(f"{source.name}: compressed by {name}; export it without mesh compression")
        if not name.startswith(_HARMLESS):
            raise UnsupportedFormat(f"{source.name}: it requires the extension {name}; export it without")
    binary = source.data.startswith(_MAGIC)
    said = json.get("buffers", [])
    buffers = tuple(_buffer(source, each, chunk if binary and i == 0 else None) for i, each in enumerate(said))
    return GltfFile(source, json, buffers, binary)


def _chunks(source: Source) -> tuple[bytes, bytes]:
    """The JSON and the binary chunk of a GLB."""
    data = source.data
    if len(data) < 20 or struct.unpack_from("<I", data, 8)[0] > len(data):
        raise source.unreadable("the container is cut off", "copy or export it again", at=len(data), text=False)
    at, found = 12, {_JSON: b"", _BIN: b""}
    while at + 8 <= len(data):
        size, kind = struct.unpack_from("<II", data, at)
        if at + 8 + size > len(data):
            raise source.unreadable("a chunk reaches beyond the file", "copy it again", at=at, text=False)
        found[kind] = found.get(kind) or data[at + 8 : at + 8 + size]
        at += 8 + size
    return found[_JSON], found[_BIN]


def _buffer(source: Source, said: dict[str, Any], chunk: bytes | None) -> bytes:
    uri = said.get("uri")
    if uri is None:
        return chunk or b""
    if uri.startswith("data:"):
        try:
            return base64.b64decode(uri.partition(",")[2], validate=True)
        except binascii.Error as error:
            raise source.unreadable(f"a buffer in the description is damaged: {error}", "export it again") from error
    path = companion(source.folder, uri)
    if path is None:
        raise source.unreadable(f"the buffer {uri[:80]!r} is not there", "put it beside the file")
    return path.read_bytes()


def companion(folder: Path | None, uri: str) -> Path | None:
    """A file that a description names, if it is there."""
    return mtl.find(unquote(uri), folder) if folder is not None and ":" not in uri else None


def packed(json: dict[str, Any], chunk: bytes | bytearray, *, binary: bool, pretty: bool = False) -> list[bytes]:
    """A file's parts: a GLB of a description and its first buffer, or the description alone."""
    text = orjson.dumps(json, option=orjson.OPT_SERIALIZE_NUMPY | (orjson.OPT_INDENT_2 if pretty else 0))
    if not binary:
        return [text]
    text += b" " * (-len(text) % 4)
    body = bytes(chunk) + b"\0" * (-len(chunk) % 4)
    parts = [struct.pack("<II", len(text), _JSON), text]
    if body:
        parts += [struct.pack("<II", len(body), _BIN), body]
    return [_MAGIC + struct.pack("<II", 2, 12 + sum(map(len, parts))), *parts]
