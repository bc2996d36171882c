"""What can have keys: the values of a layer that are numbers, checked before they are kept, and put into place."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import InvalidParameter, PliantError
from pliant.scene.layer import Layer
from pliant.space.affine import Affine
from pliant.space.placed import Placed, place

Floats = NDArray[np.float64]


def checked_value(layer: Layer, field: str, value: Any) -> Floats:
    """A key's value as numbers, if the layer can have it.

    Raises
    ------
    InvalidParameter
        The layer has no such value, or none of that shape; or the deformer refuses it.
    """
    try:
        numbers = np.asarray(value.matrix if isinstance(value, Affine) else value, np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidParameter(
            f"a key of {field!r} of layer {layer.name!r} is {value!r}: numbers are needed"
        ) from error
    try:
        keyed_layer(layer, {field: numbers})
    except InvalidParameter:
        raise
    except PliantError as error:
        raise InvalidParameter(f"a key of {field!r} of layer {layer.name!r} is refused: {error}") from error
    return numbers


def keyed_layer(layer: Layer, values: Mapping[str, Floats]) -> Layer:
    """The layer with some of its values as keys say."""
    changes: dict[str, Any] = {}
    deformer = layer.deformer
    for field, value in values.items():
        if field == "envelope":
            changes["envelope"] = _number(field, value, layer)
        elif field == "muted":
            changes["muted"] = _number(field, value, layer) >= 0.5
        elif field == "controls":
            deformer = deformer.moved(value)
    own = {field: value for field, value in values.items() if field not in ("envelope", "muted", "controls", "frame")}
    if own:
        deformer = _with_fields(deformer, own, layer)
    if "frame" in values:
        deformer = _placed(deformer, values["frame"], layer)
    return layer.changed(deformer=deformer, **changes) if changes or deformer is not layer.deformer else layer


def tool_of(deformer: Deformer) -> Deformer:
    """What is placed, or the deformer itself."""
    return deformer.deformer if isinstance(deformer, Placed) else deformer


def _with_fields(deformer: Deformer, values: Mapping[str, Floats], layer: Layer) -> Deformer:
    """The deformer with other numbers; of a placed one, those of the tool."""
    if isinstance(deformer, Placed):
        inner = _with_fields(deformer.deformer, values, layer)
        assert isinstance(inner, SpaceDeformer)
        return Placed(inner, deformer.frame)
    fields: Any = deformer
    numeric = {
        each.name: np.asarray(getattr(deformer, each.name), np.float64)
        for each in dataclasses.fields(fields)
        if each.init and _is_numeric(getattr(deformer, each.name))
    }
    given: dict[str, Any] = {}
    for field, value in values.items():
        if field not in numeric:
            known = ", ".join([*numeric, "controls", "envelope", "muted", "frame"])
            raise InvalidParameter(f"layer {layer.name!r} has no {field!r} that could have keys; it has: {known}")
        if value.shape != numeric[field].shape:
            raise InvalidParameter(
                f"{field!r} of layer {layer.name!r} has shape {numeric[field].shape}; the key's has {value.shape}"
            )
        given[field] = float(value) if value.ndim == 0 else value
    changed: Deformer = dataclasses.replace(fields, **given)
    return changed


def _placed(deformer: Deformer, frame: Floats, layer: Layer) -> Deformer:
    if frame.shape != (4, 4):
        raise InvalidParameter(
            f"the frame of layer {layer.name!r} has shape {frame.shape}; an Affine, (4, 4), is needed"
        )
    if isinstance(deformer, Placed):
        return deformer.at(Affine(frame))
    if not isinstance(deformer, SpaceDeformer):
        raise InvalidParameter(f"layer {layer.name!r} edits a surface: only maps of space can be placed")
    return place(deformer, Affine(frame))


def _is_numeric(value: Any) -> bool:
    """Whether a value changes in proportion: numbers and arrays of them, but no counts, words or truth values."""
    if isinstance(value, np.ndarray):
        return bool(value.dtype.kind == "f")
    if isinstance(value, tuple):
        return bool(value) and all(isinstance(item, float) for item in value)
    return isinstance(value, float)


def _number(field: str, value: Floats, layer: Layer) -> float:
    if value.shape:
        raise InvalidParameter(
            f"{field!r} of layer {layer.name!r} is one number; the key's value has shape {value.shape}"
        )
    return float(value)
