"""Damage inside sound packings: what a checksum or a length would give away at once is made to fit again."""

from __future__ import annotations

import gzip
import io
import json
import random
import struct
import zipfile
from collections.abc import Sequence
from typing import Any

import numpy as np

from reliability.mutate import damaged

_VALUES: tuple[Any, ...] = (
    None, True, -1, 0, 1, 2**31, 2**63, 1e300, -1e-300, "", "x", "../../x", [], {}, [[]], [[0.5]],
)  # fmt: skip
_CHUNK = 0x4E4F534A


def damaged_inside(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes | None:
    """A sound packing of damaged contents; None where the bytes are no packing that is known here."""
    if data[:2] == b"\x1f\x8b":
        inner = gzip.decompress(data)
        return gzip.compress(damaged_inside(inner, rng, others) or damaged(inner, rng, others), 1, mtime=0)
    if data[:4] == b"PK\x03\x04":
        return _zip(data, rng, others)
    if data[:4] == b"glTF":
        return _glb(data, rng)
    if data[:8] == b"\x89HDF\r\n\x1a\n":
        return _hdf5(data, rng)
    try:
        document = json.loads(data)
    except (ValueError, RecursionError):
        return None
    return _text(document, rng)


def _text(document: Any, rng: random.Random) -> bytes:
    for _ in range(rng.choice([1, 1, 2])):
        document = _changed(document, rng)
    return json.dumps(document).encode()


def _changed(value: Any, rng: random.Random) -> Any:
    """JSON with one value replaced, doubled, left out, or moved elsewhere."""
    if isinstance(value, (dict, list)) and value and rng.random() < 0.85:
        keys = list(value) if isinstance(value, dict) else list(range(len(value)))
        at, copy = rng.choice(keys), (dict(value) if isinstance(value, dict) else list(value))
        if rng.random() < 0.1:
            del copy[at]
        elif rng.random() < 0.1:
            copy[at] = copy[rng.choice(keys)]
        else:
            copy[at] = _changed(value[at], rng)
        return copy
    if isinstance(value, list) and rng.random() < 0.3:
        return value + value
    if isinstance(value, (int, float)) and rng.random() < 0.4:
        return value + rng.choice([-1, 1, 0.5, 1e9, -2 * value])
    return rng.choice(_VALUES)


def _zip(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as package, zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as made:
        contents = {name: package.read(name) for name in package.namelist()}
        chosen = rng.choice(list(contents)) if rng.random() < 0.5 else next(iter(contents))
        inner = contents[chosen]
        contents[chosen] = damaged_inside(inner, rng, others) or damaged(inner, rng, others)
        if chosen.startswith("arrays/"):
            contents["manifest.json"] = _signed(contents["manifest.json"], chosen, contents[chosen])
        for name, content in contents.items():
            made.writestr(zipfile.ZipInfo(name), content)
    return out.getvalue()


def _signed(manifest: bytes, file: str, content: bytes) -> bytes:
    """A project's manifest with the hash of an array that was damaged, so that the array is looked at."""
    from pliant.scene.keys import array_key

    try:
        key = array_key(np.load(io.BytesIO(content), allow_pickle=False)).hex()
    except Exception:
        return manifest
    document = json.loads(manifest)
    for place in document["arrays"].values():
        if place["file"] == file:
            place["hash"] = key
    return json.dumps(document).encode()


def _glb(data: bytes, rng: random.Random) -> bytes:
    (length,) = struct.unpack_from("<I", data, 12)
    text, rest = _text(json.loads(data[20 : 20 + length]), rng), data[20 + length :]
    text += b" " * (-len(text) % 4)
    return b"glTF" + struct.pack("<IIII", 2, 20 + len(text) + len(rest), len(text), _CHUNK) + text + rest


def _hdf5(data: bytes, rng: random.Random) -> bytes:
    """One dataset less, or with other numbers, another shape or another type."""
    import h5py

    stream = io.BytesIO(data)
    with h5py.File(stream, "r+", track_order=False) as stored:
        names: list[str] = []
        stored.visit(names.append)
        at = rng.choice(names)
        value = stored[at][()] if isinstance(stored[at], h5py.Dataset) else None
        attributes = dict(stored[at].attrs)
        if rng.random() < 0.3:
            _damage_attribute(stored[at].attrs, rng)
        else:
            del stored[at]
            if rng.random() < 0.85:
                made = stored.create_dataset(at, data=_other(value, rng), track_times=False)
                for name, attribute in attributes.items():
                    made.attrs[name] = attribute
    return stream.getvalue()


def _damage_attribute(attributes: Any, rng: random.Random) -> None:
    if len(attributes):
        name = rng.choice(list(attributes))
        attributes[name] = rng.choice([-1, 0, 2**31, 1e300, "x", np.zeros((2, 2))])


def _other(value: Any, rng: random.Random) -> Any:
    if not isinstance(value, np.ndarray) or value.dtype.kind not in "biuf" or not value.size:
        return rng.choice([b"x", "x", "../x", -1, 1e300, np.zeros((0, 3)), np.zeros((2, 2, 2))])
    flat = value.astype(float).reshape(-1)
    kind = rng.randrange(6)
    if kind == 0:
        flat[rng.randrange(len(flat))] = rng.choice([np.nan, np.inf, 1e300, -1.0, 0.0, 2**31, 2**62])
        return flat.reshape(value.shape) if rng.random() < 0.5 or value.dtype.kind == "f" else flat.clip(
            -(2**62), 2**62).astype(np.int64).reshape(value.shape)  # fmt: skip
    if kind == 1:
        return value[: rng.randrange(len(value) + 1)] if value.ndim else value
    if kind == 2:
        return value.T
    if kind == 3:
        return np.concatenate([flat, flat])
    if kind == 4:
        return value.astype(rng.choice(["f2", "i1", "u8", "S4", "f8"]))
    return flat * rng.choice([0.0, -1.0, 1e308, 1e-308])
