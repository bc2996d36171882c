"""Model files as HDF5-JSON, the container that newer Scalismo writes: groups and datasets by UUID, with aliases."""

from __future__ import annotations

import uuid
from pathlib import Path
from typing import Any

import numpy as np
import orjson

from pliant.errors import UnreadableFile
from pliant.io.model_formats.model_tree import Tree, Value, simple

_NAMESPACE = uuid.UUID("0f5c1f6e-6e0c-5b8e-9f0a-8d5f3c1d7a10")  # identifiers follow from paths: files are reproducible
_TYPES = {
    "H5T_IEEE_F32": np.float32,
    "H5T_IEEE_F64": np.float64,
    "H5T_STD_I32": np.int32,
    "H5T_STD_I64": np.int64,
    "H5T_STD_U32": np.uint32,
    "H5T_STD_U8": np.uint8,
}


def from_json(path: Path, data: bytes) -> Tree:
    """The contents of an HDF5-JSON file.

    Raises
    ------
    UnreadableFile
        It is no such JSON.
    """
    try:
        stored = orjson.loads(data)
        tree = Tree()
        for group in stored["groups"].values():
            for place in group.get("alias", ()):
                if place != "/":
                    tree.groups.add(str(place))
                    found = {each["name"]: simple(each["value"]) for each in group.get("attributes", ())}
                    tree.attributes[place] = {name: word for name, word in found.items() if isinstance(word, str)}
        for dataset in stored["datasets"].values():
            value = _value(dataset)
            if value is not None:
                tree.values.update({str(place): value for place in dataset.get("alias", ())})
    except (orjson.JSONDecodeError, KeyError, TypeError, AttributeError, ValueError, OverflowError) as error:
        raise UnreadableFile(path, f"it is no HDF5-JSON: {error}", "the file is cut off or damaged") from error
    return tree


def _value(dataset: dict[str, Any]) -> Value | None:
    value, kind = dataset.get("value"), dataset["type"]
    if value is None:
        return None
    if kind["class"] == "H5T_STRING":
        return simple(value)
    known = next((each for name, each in _TYPES.items() if str(kind.get("base", "")).startswith(name)), None)
    if known is None:
        return None
    return np.asarray(value, known).reshape(dataset["shape"].get("dims", ()))


def to_json(tree: Tree) -> bytes:
    """An HDF5-JSON file."""
    groups: dict[str, dict[str, Any]] = {}
    for place in sorted({above for each in [*tree.groups, *tree.values] for above in _above(each)} | tree.groups):
        groups[_id(place)] = {"alias": [place], "links": []}
        words = tree.attributes.get(place, {})
        if words:
            groups[_id(place)]["attributes"] = [
                {"name": name, "shape": {"class": "H5S_SCALAR"}, "type": _string(word), "value": word}
                for name, word in words.items()
            ]
    datasets = {}
    for place, value in tree.values.items():
        datasets[_id(place)] = {"alias": [place], **_described(value)}
        _link(groups, place, "datasets")
    for group in list(groups.values()):
        if group["alias"] != ["/"]:
            _link(groups, group["alias"][0], "groups")
    stored = {"apiVersion": "1.1.1", "datasets": datasets, "groups": groups, "root": _id("/")}
    return orjson.dumps(stored, option=orjson.OPT_SERIALIZE_NUMPY | orjson.OPT_INDENT_2)


def _described(value: Value) -> dict[str, Any]:
    if isinstance(value, str):
        return {"shape": {"class": "H5S_SCALAR"}, "type": _string(value), "value": value}
    base = next(name for name, each in _TYPES.items() if value.dtype == each)
    kind = "H5T_FLOAT" if value.dtype.kind == "f" else "H5T_INTEGER"
    end = "" if value.dtype.itemsize == 1 else "LE"
    shape = {"class": "H5S_SIMPLE", "dims": list(value.shape)} if value.ndim else {"class": "H5S_SCALAR"}
    plain = np.ascontiguousarray(value) if value.ndim else value.item()
    return {"shape": shape, "type": {"base": base + end, "class": kind}, "value": plain}


def _string(word: str) -> dict[str, Any]:
    length = len(word.encode())
    return {"charSet": "H5T_CSET_ASCII", "class": "H5T_STRING", "length": length, "strPad": "H5T_STR_NULLPAD"}


def _link(groups: dict[str, dict[str, Any]], place: str, collection: str) -> None:
    title = place.rpartition("/")[2]
    link = {"class": "H5L_TYPE_HARD", "collection": collection, "id": _id(place), "title": title}
    groups[_id(_parent(place))]["links"].append(link)


def _above(place: str) -> list[str]:
    """The groups that a path leads through, the root too."""
    words = place.split("/")[:-1]
    return ["/".join(words[: i + 1]) or "/" for i in range(len(words))]


def _parent(place: str) -> str:
    return place.rpartition("/")[0] or "/"


def _id(place: str) -> str:
    return str(uuid.uuid5(_NAMESPACE, place))
