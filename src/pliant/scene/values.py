"""Values as plain data and back: numbers and words as they are, arrays aside, records by their fields.

Plain data is what JSON holds. An array of some size is put aside under a name and stands as ``{"array": name}``; a
deformer is ``{"kind": name, "fields": {...}}``, any other record ``{"record": name, "fields": {...}}``. Only records
of pliant are ever made from data, by their constructors, which check what they are given: no code is stored or run.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer
from pliant.errors import InvalidParameter, PliantError
from pliant.scene.rooms import deformer_classes, known_as, records

Arrays = dict[str, NDArray[Any]]
Opaque = Callable[[Any], str]

INLINE = 16  # numbers: arrays of no more stand in the data itself
_DTYPES = {name: np.dtype(name) for name in ("bool", "int32", "int64", "uint8", "float32", "float64")}
SKIPPED = ("carrier",)  # what a reader kept of a file: not part of what a thing is


def encode(value: Any, arrays: Arrays, name: str, opaque: Opaque | None = None) -> Any:
    """A value as plain data.

    Parameters
    ----------
    value
        Numbers, words, paths, arrays, sequences and mappings of such, records.
    arrays
        Where arrays are put aside.
    name
        What the value is called: arrays are named after it.
    opaque
        What to write for things that no data can hold; None = they are refused.

    Raises
    ------
    InvalidParameter
        A function, or an object of another library.
    """
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, int | float | np.number | np.bool_):
        return _number(value)
    if isinstance(value, np.ndarray):
        return _array(value, arrays, name)
    if isinstance(value, Path):
        return {"path": str(value)}
    if isinstance(value, tuple | list):
        return [encode(item, arrays, f"{name}/{i}", opaque) for i, item in enumerate(value)]
    if isinstance(value, Mapping):
        return {"mapping": {str(key): encode(item, arrays, f"{name}/{key}", opaque) for key, item in value.items()}}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        tag, label = ("kind", known_as(type(value))) if isinstance(value, Deformer) else ("record", _recorded(value))
        if label is not None:
            return {tag: label, "fields": encode_fields(value, arrays, name, opaque)}
    if opaque is not None:
        return {"opaque": opaque(value)}
    what = "a Python function" if callable(value) else f"a {type(value).__module__}.{type(value).__name__}"
    raise InvalidParameter(f"{name} is {what}, which no file can hold: give numbers, names or keys instead")


def encode_fields(record: Any, arrays: Arrays, name: str, opaque: Opaque | None = None) -> dict[str, Any]:
    """The fields of a record as plain data, by name; carriers are left out."""
    fields = [field.name for field in dataclasses.fields(record) if field.init and field.name not in SKIPPED]
    start = f"{name}/" if name else ""
    return {field: encode(getattr(record, field), arrays, start + field, opaque) for field in fields}


def decode(data: Any, arrays: Mapping[str, NDArray[Any]]) -> Any:
    """The value that plain data stands for.

    Raises
    ------
    InvalidParameter
        A kind, a record or an array that there is not, or fields that its constructor refuses to take.
    """
    if isinstance(data, list):
        return tuple(decode(item, arrays) for item in data)
    if not isinstance(data, dict):
        return data
    if "array" in data:
        return _stored(data, arrays)
    if data == {"none": True}:
        return None
    if "float" in data:
        return float(data["float"])
    if "path" in data:
        return Path(str(data["path"]))
    if "mapping" in data:
        return {key: decode(item, arrays) for key, item in _mapping(data["mapping"]).items()}
    for tag in ("kind", "record"):
        if tag in data:
            return make(_named(tag, data[tag]), _mapping(data.get("fields", {})), arrays)
    raise InvalidParameter(f"data with the names {', '.join(map(str, data))} is nothing that pliant knows")


def make(kind: type[Any], fields: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> Any:
    """A record from its fields as plain data.

    Raises
    ------
    InvalidParameter
        A field that it has not, that is missing, or of a type that it does not take.
    """
    known = [field.name for field in dataclasses.fields(kind) if field.init]
    for name in fields:
        if name not in known:
            raise InvalidParameter(f"a {kind.__name__} has no field {name!r}; it has: {', '.join(known)}")
    values = {name: decode(item, arrays) for name, item in fields.items()}
    try:
        return kind(**values)
    except PliantError:
        raise
    except (TypeError, ValueError, ArithmeticError, LookupError, AttributeError) as error:
        raise InvalidParameter(f"no {kind.__name__} can be made of these fields: {error}") from error


def _recorded(value: Any) -> str | None:
    name = type(value).__name__
    return name if records().get(name) is type(value) else None


def _number(value: Any) -> Any:
    plain = value.item() if isinstance(value, np.generic) else value
    if isinstance(plain, complex):
        raise InvalidParameter(f"the number {plain} is complex: only real ones are stored")
    return plain if not isinstance(plain, float) or math.isfinite(plain) else {"float": repr(plain)}


def _array(value: NDArray[Any], arrays: Arrays, name: str) -> Any:
    if value.dtype.hasobject:
        raise InvalidParameter(f"{name} is an array of Python objects: only numbers, words and truth values are stored")
    if value.dtype == np.float64 and value.ndim and 0 < value.size <= INLINE and np.isfinite(value).all():
        return {"array": value.tolist()} if value.ndim > 2 else value.tolist()
    arrays[name] = value
    return {"array": name}


def _stored(data: dict[str, Any], arrays: Mapping[str, NDArray[Any]]) -> NDArray[Any]:
    name = data["array"]
    if isinstance(name, list):
        try:
            return np.array(name, _DTYPES[data.get("dtype", "float64")])
        except (TypeError, ValueError, KeyError, OverflowError) as error:
            raise InvalidParameter(f"an array is not one of numbers: {error}") from error
    if not isinstance(name, str) or name not in arrays:
        raise InvalidParameter(f"the array {name!r} is missing")
    return arrays[name]


def _named(tag: str, name: Any) -> type[Any]:
    known = deformer_classes() if tag == "kind" else records()
    if not isinstance(name, str) or name not in known:
        what = f"deformers are: {', '.join(known)}" if tag == "kind" else "a newer version of pliant may know it"
        raise InvalidParameter(f"there is no {tag} {name!r} ({what})")
    return known[name]


def _mapping(data: Any) -> dict[str, Any]:
    if not isinstance(data, dict):
        raise InvalidParameter(f"names and values are needed, not {type(data).__name__}")
    return data
