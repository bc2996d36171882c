"""Stacks and layers as plain data and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.scene.kinds import build, describe
from pliant.scene.layer import Layer
from pliant.scene.stack import Stack
from pliant.scene.values import Arrays, decode, encode

SWITCHES = {"invert": False, "muted": False, "solo": False}


def stack_data(stack: Stack, arrays: Arrays) -> dict[str, Any]:
    """A stack as plain data; arrays are put aside.

    Raises
    ------
    InvalidParameter
        A layer holds what no data can, such as a function; the layer is named.
    """
    return {"mode": stack.mode, "layers": [_layer_data(layer, arrays, i) for i, layer in enumerate(stack.layers)]}


def stack_of(data: Any, arrays: Mapping[str, NDArray[Any]]) -> Stack:
    """The stack that plain data describes.

    Raises
    ------
    InvalidParameter
        A layer of an unknown kind, or with fields that it does not take; the layer is named.
    """
    if not isinstance(data, dict) or not isinstance(data.get("layers", []), list):
        raise InvalidParameter("a stack has a mode and a list of layers")
    mode = data.get("mode", "compose")
    return Stack(tuple(_layer_of(each, arrays, i) for i, each in enumerate(data.get("layers", []))), mode)


def _layer_data(layer: Layer, arrays: Arrays, place: int) -> dict[str, Any]:
    try:
        kind, fields, own = describe(layer.deformer)
    except InvalidParameter as error:
        raise InvalidParameter(f"layer {layer.name!r} cannot be stored: {error}") from error
    prefix = f"layers/{place}/"
    arrays.update({prefix + name: array for name, array in own.items()})
    data: dict[str, Any] = {"name": layer.name, "kind": kind, "fields": _renamed(fields, prefix)}
    if layer.envelope != 1.0:
        data["envelope"] = layer.envelope
    data.update({name: True for name in SWITCHES if getattr(layer, name)})
    if layer.mask is not None:
        data["mask"] = encode(np.asarray(layer.mask), arrays, prefix + "mask")
    return data


def _layer_of(data: Any, arrays: Mapping[str, NDArray[Any]], place: int) -> Layer:
    if not isinstance(data, dict) or not isinstance(data.get("name"), str) or not isinstance(data.get("kind"), str):
        raise InvalidParameter(f"layer {place} has no name, or no kind: both are words")
    name = data["name"]
    known = ("name", "kind", "fields", "mask", "envelope", *SWITCHES)
    for key in data:
        if key not in known:
            raise InvalidParameter(f"layer {name!r} has an unknown entry {key!r}; there are: {', '.join(known)}")
    fields = data.get("fields", {})
    if not isinstance(fields, dict):
        raise InvalidParameter(f"the fields of layer {name!r} are no names and values")
    try:
        deformer = build(data["kind"], fields, arrays)
        mask = decode(data["mask"], arrays) if "mask" in data else None
        switches = {switch: bool(data.get(switch, False)) for switch in SWITCHES}
        return Layer(name, deformer, mask, envelope=data.get("envelope", 1.0), **switches)
    except InvalidParameter as error:
        raise InvalidParameter(f"layer {name!r}: {error}") from error


def _renamed(data: Any, prefix: str) -> Any:
    """Plain data whose arrays are found under longer names."""
    if isinstance(data, list):
        return [_renamed(item, prefix) for item in data]
    if isinstance(data, dict):
        if isinstance(data.get("array"), str) and len(data) == 1:
            return {"array": prefix + data["array"]}
        return {key: _renamed(item, prefix) for key, item in data.items()}
    return data
