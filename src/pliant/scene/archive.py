"""A zip of a JSON manifest and arrays as .npy: written so that nothing is ever lost, read without trust.

Nothing in it is executed, nothing is unpacked to disk, and nothing is allocated before its size has been checked
against the bytes that are there.
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import orjson
from numpy.typing import NDArray

from pliant.errors import UnreadableFile
from pliant.io.files import replacing
from pliant.scene.keys import array_key
from pliant.scene.values import Arrays

MANIFEST = "manifest.json"
MOST_ENTRIES, MOST_TEXT, GROWTH = 10_000, 64 << 20, 100
_ENTRY = re.compile(r"arrays/[0-9]{1,6}\.npy")
_CURE = "open a copy, or save the project again"


def write_archive(path: Path | str, manifest: Mapping[str, Any], arrays: Arrays) -> None:
    """Write a manifest and its arrays; equal arrays are stored once, and not compressed: disks are faster.

    Raises
    ------
    UnwritableFile
        The disk is full, or the place is not writable. What was there before stays.
    """
    stored: dict[str, NDArray[Any]] = {}
    named: dict[str, dict[str, str]] = {}
    files: dict[str, str] = {}
    for name, array in arrays.items():
        key = array_key(array).hex()
        file = files.setdefault(key, f"arrays/{len(files)}.npy")
        stored[file], named[name] = array, {"file": file, "hash": key}
    with replacing(path, durable=True) as temporary, zipfile.ZipFile(temporary, "w") as archive:
        text = orjson.dumps({**manifest, "arrays": named}, option=orjson.OPT_INDENT_2)
        archive.writestr(zipfile.ZipInfo(MANIFEST), text)
        for file, array in stored.items():
            with archive.open(zipfile.ZipInfo(file), "w", force_zip64=True) as stream:
                np.lib.format.write_array(stream, np.ascontiguousarray(array), allow_pickle=False)


def read_archive(path: Path | str) -> tuple[dict[str, Any], Arrays]:
    """The manifest and the arrays of a file.

    Raises
    ------
    UnreadableFile
        It is no such archive, is cut off or damaged, or claims what it cannot hold.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            entries = _checked(archive, path)
            manifest = _manifest(archive, entries, path)
            return manifest, _arrays(archive, entries, manifest.pop("arrays", {}), path)
    except (OSError, ValueError) as error:  # ValueError: a name with a zero byte
        raise UnreadableFile(path, getattr(error, "strerror", None) or str(error), "check the path") from error
    except (zipfile.BadZipFile, zipfile.LargeZipFile, NotImplementedError, EOFError, RuntimeError) as error:
        raise UnreadableFile(path, f"it is no sound zip archive: {error}", _CURE) from error


def _checked(archive: zipfile.ZipFile, path: Path | str) -> dict[str, zipfile.ZipInfo]:
    """The entries by name, each of which is what a project holds and no larger than its bytes allow."""
    entries: dict[str, zipfile.ZipInfo] = {}
    if len(archive.infolist()) > MOST_ENTRIES:
        raise UnreadableFile(path, f"it holds {len(archive.infolist()):,} entries; {MOST_ENTRIES:,} are the most")
    for info in archive.infolist():
        if info.filename != MANIFEST and not _ENTRY.fullmatch(info.filename):
            raise UnreadableFile(path, f"it holds {info.filename!r}, which is no part of a project", _CURE)
        if info.filename in entries:
            raise UnreadableFile(path, f"it holds {info.filename!r} twice", _CURE)
        if info.file_size > GROWTH * info.compress_size + 4096:
            raise UnreadableFile(
                path, f"{info.compress_size:,} bytes of {info.filename} inflate to {info.file_size:,}", _CURE
            )
        entries[info.filename] = info
    return entries


def _manifest(archive: zipfile.ZipFile, entries: dict[str, zipfile.ZipInfo], path: Path | str) -> dict[str, Any]:
    if MANIFEST not in entries:
        raise UnreadableFile(path, "it has no manifest: it is not a project of pliant")
    if entries[MANIFEST].file_size > MOST_TEXT:
        raise UnreadableFile(path, f"its manifest has {entries[MANIFEST].file_size:,} bytes, too many to be one")
    try:
        manifest = orjson.loads(archive.read(MANIFEST))
    except orjson.JSONDecodeError as error:
        raise UnreadableFile(path, f"its manifest is no JSON: {error}", _CURE) from error
    if not isinstance(manifest, dict):
        raise UnreadableFile(path, "its manifest is no object of names and values", _CURE)
    return manifest


def _arrays(archive: zipfile.ZipFile, entries: dict[str, zipfile.ZipInfo], named: Any, path: Path | str) -> Arrays:
    if not isinstance(named, dict):
        raise UnreadableFile(path, "its list of arrays is no object of names and values", _CURE)
    loaded: dict[str, NDArray[Any]] = {}
    arrays: Arrays = {}
    for name, place in named.items():
        file = place.get("file") if isinstance(place, dict) else None
        if not isinstance(file, str) or file not in entries or file == MANIFEST:
            raise UnreadableFile(path, f"the array {name!r} should be in {file!r}, which is not there", _CURE)
        if file not in loaded:
            loaded[file] = _array(archive.read(file), file, path)
            if array_key(loaded[file]).hex() != place.get("hash"):
                raise UnreadableFile(path, f"{file} is not what was saved: its hash is another one", _CURE)
        arrays[name] = loaded[file]
    return arrays


def _array(data: bytes, file: str, path: Path | str) -> NDArray[Any]:
    """An array from the bytes of a .npy file, read-only; nothing is allocated that its header only claims."""
    stream = BytesIO(data)
    try:
        version = np.lib.format.read_magic(stream)
        if version != (1, 0):
            raise ValueError(f"version {version}")
        shape, fortran, dtype = np.lib.format.read_array_header_1_0(stream)
    except Exception as error:  # whatever NumPy's parser says of a hostile header
        raise UnreadableFile(path, f"{file} is no .npy file: {error}", _CURE) from error
    start, size = stream.tell(), dtype.itemsize
    count = 1
    for extent in shape:
        count *= extent
    if dtype.hasobject or dtype.kind not in "biufUS" or fortran or min(shape, default=0) < 0 or len(shape) > 8:
        raise UnreadableFile(
            path, f"{file} holds {dtype} of shape {shape}: only plain arrays of numbers are read", _CURE
        )
    if count * size != len(data) - start:
        raise UnreadableFile(
            path, f"{file} claims shape {shape}, {count * size:,} bytes; there are {len(data) - start:,}", _CURE
        )
    if not count:
        return np.empty(shape, dtype)
    return np.frombuffer(data, dtype, count, start).reshape(shape)
