"""Content as keys: what is equal has the same key, whoever made it and when.

A deformer has two: one of its structure, which bindings depend on, and one of its structure and its controls.
"""

from __future__ import annotations

import weakref
from dataclasses import replace
from hashlib import blake2b
from typing import Any

import numpy as np
import orjson
from numpy.typing import NDArray

from pliant.deformer import Deformer, MeshDeformer
from pliant.scene.values import Arrays, encode

_REMEMBERED = 1 << 16  # bytes: arrays that are smaller are hashed again each time
_known: dict[int, bytes] = {}


def key_of(*parts: Any) -> bytes:
    """The key of other keys and of any values that can be encoded; functions are known by identity."""
    arrays: Arrays = {}
    named = [part.hex() if isinstance(part, bytes) else part for part in parts]
    data = encode(named, arrays, "", opaque=lambda thing: f"{type(thing).__qualname__} {id(thing)}")
    digest = blake2b(orjson.dumps(data), digest_size=16)
    for name, array in arrays.items():
        digest.update(name.encode() + array_key(array))
    return digest.digest()


def array_key(array: NDArray[Any]) -> bytes:
    """The key of an array's type, shape and numbers; of large read-only ones it is remembered while they live."""
    if array.nbytes >= _REMEMBERED and _settled(array):
        if id(array) not in _known:
            _known[id(array)] = _hashed(array)
            weakref.finalize(array, _known.pop, id(array), None)
        return _known[id(array)]
    return _hashed(array)


def _settled(array: NDArray[Any]) -> bool:
    """Whether nobody can write the numbers: the array is read-only, and so is all that it is a view of."""
    base: Any = array
    while isinstance(base, np.ndarray):
        if base.flags.writeable:
            return False
        base = base.base
    return base is None or isinstance(base, bytes)


def structure_key(deformer: Deformer) -> bytes:
    """The key of what a binding of the deformer depends on, beside its target: all but its controls."""
    if isinstance(deformer, MeshDeformer):
        fields: Any = deformer
        at_rest = replace(fields, goal=None) if getattr(fields, "goal", None) is not None else fields
        return key_of("structure", at_rest)
    return key_of("structure", deformer.moved(deformer.rest))


def _hashed(array: NDArray[Any]) -> bytes:
    digest = blake2b(f"{array.dtype.str}{array.shape}".encode(), digest_size=16)
    digest.update(np.ascontiguousarray(array).reshape(-1).view(np.uint8).data if array.size else b"")
    return digest.digest()
